"""Shortcuts in Hydra and OmegaConf: names and values that refer to others are the same as without them."""

import pytest
from hydra._internal import defaults_list
from hydra.core.default_element import GroupDefault
from omegaconf import OmegaConf, base
from omegaconf.errors import GrammarParseError

from runner.config.compose.shortcuts import take_shortcuts


@pytest.fixture(autouse=True)
def _taken():
    take_shortcuts()


def test_an_interpolation_has_the_value_of_its_own_config():
    for value in (1, 2):
        config = OmegaConf.create({"a": value, "b": "${a}", "c": "x${a}", "d": {"e": "${.f}", "f": value}})
        plain = OmegaConf.to_container(config, resolve=True)
        assert plain == {"a": value, "b": value, "c": f"x{value}", "d": {"e": value, "f": value}}


def test_a_text_is_parsed_once_and_a_faulty_one_refused_each_time():
    assert base.parse("${a}") is base.parse("${a}") is not base.parse("${b}")
    for _ in range(2):
        with pytest.raises(GrammarParseError):
            base.parse("${a")


@pytest.mark.parametrize(("value", "read"), [("one", False), ("${other}", True)])
def test_choices_are_mapped_where_a_name_refers_to_them(value, read):
    overrides = type("Overrides", (), {"known_choices": {"other": "two"}})
    default = GroupDefault(group="group", value=value)
    default.update_parent("", "")
    found = defaults_list._create_interpolation_map(overrides, [default], False)
    assert (found is not None) == read
    if read:
        assert found.other == "two"
