"""Values of nested configs by dotted keys."""

import pytest

from runner.base.dotted_keys import dotted, get, leaves, put

CONFIG = {"a": {"b": 1, "c": [2, {"d": 3}]}, "e": {}, "f": []}


@pytest.mark.parametrize(
    ("lists", "found"),
    [
        (True, {"a.b": 1, "a.c.0": 2, "a.c.1.d": 3, "e": {}, "f": []}),
        (False, {"a.b": 1, "a.c": [2, {"d": 3}], "e": {}, "f": []}),
    ],
)
def test_leaves_are_the_values_and_what_is_empty(lists, found):
    assert {dotted(place): value for place, value in leaves(CONFIG, lists=lists)} == found


def test_an_empty_config_has_none():
    assert list(leaves({})) == []


def test_a_place_may_begin_in_a_larger_config():
    assert [dotted(place) for place, _ in leaves({"b": 1}, ("a",))] == ["a.b"]


@pytest.mark.parametrize(("key", "value"), [("a.b", 1), (("a", "b"), 1), ("e", {}), ("a.x", None), ("a.b.x", None)])
def test_values_are_found_by_key_or_place(key, value):
    assert get(CONFIG, key) == value


def test_values_are_put_in_place():
    config = {"a": {"c": [2, {"d": 3}]}}
    put(config, ("a", "c", 1, "d"), 4)
    put(config, ("a", "new"), 5)
    assert config == {"a": {"c": [2, {"d": 4}], "new": 5}}
