"""Values of Python become overrides that Hydra reads as the same values."""

from pathlib import Path

import numpy as np
import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from support.grids import plan_sweep

from runner.api.overrides import run_overrides, sweep_overrides, tuning_overrides
from runner.base.errors import ConfigError


def read(text):
    (override,) = OverridesParser.create().parse_overrides([text])
    return override.value()


@pytest.mark.parametrize(
    "value",
    [
        True,
        False,
        None,
        0,
        -3,
        10**20,
        0.1,
        1e-300,
        -1.5e12,
        [],
        [1, 2.5, None],
        [[1, 2], [3]],
        {"a": 1, "b": [True]},
    ],
    ids=str,
)
def test_a_value_comes_back_as_it_was(value):
    assert read(*run_overrides([], {"key": value})) == value


@pytest.mark.parametrize(
    "value", [np.float64(0.1), np.int32(7), np.bool_(True), np.array([0.1, 0.2]), np.zeros((2, 2))]
)
def test_a_value_of_numpy_is_that_of_python(value):
    (text,) = run_overrides([], {"key": value})
    np.testing.assert_array_equal(read(text), value)


@pytest.mark.parametrize(
    "name",
    [
        "plain",
        "Übung",
        "with space",
        "comma,s",
        "it's",
        'quo"te',
        "back\\slash",
        "end\\",
        "b[r]ack{e}t",
        "a=b",
        "ä:ö #%",
    ],
)
def test_a_path_and_a_text_in_a_list_are_read_letter_by_letter(name):
    (path, texts) = run_overrides([], {"a": Path("folder") / name, "b": [name]})
    assert str(read(path)).strip("'") == f"folder/{name}" or read(path).text == f"folder/{name}"
    (item,) = read(texts)
    assert getattr(item, "text", item) == name


def test_no_path_is_an_interpolation():
    assert run_overrides([], {"a": Path("${oc.env:HOME}")}) == [r"a='\${oc.env:HOME}'"]


def test_a_text_is_what_it_is_on_the_command_line():
    assert run_overrides(["x=1"], {"a__b": "[1, 2]", "noise": "none", "c.d": "45deg"}) == [
        "x=1", "a.b=[1, 2]", "noise=none", "c.d=45deg",
    ]  # fmt: skip


def test_axes_of_a_sweep():
    values = {
        "robot": ["macro", "mini"],
        "noise__position": (1e-4, 1e-3),
        "seed": range(20),
        "a": range(0, 10, 2),
        "b": np.array([0.5, 1.0]),
        "c": [[1, 2], [3, 4]],
        "d": [None, True],
        "e": "1,2",
        "f": 3,
        "g": ["x y", "z"],
    }
    entries = sweep_overrides([], values)
    assert [each if isinstance(each, str) else each.typed for each in entries] == [
        "robot=macro,mini", "noise.position=0.0001,0.001", "seed=range(0,20)", "a=range(0,10,2)", "b=0.5,1.0",
        "c=[1,2],[3,4]", "d=null,true", "e=1,2", "f=3", "g='x y',z",
    ]  # fmt: skip
    assert [each.values for each in entries if not isinstance(each, str)] == [
        ["macro", "mini"], [1e-4, 1e-3], range(20), range(0, 10, 2), [0.5, 1.0], [[1, 2], [3, 4]], [None, True],
        ["x y", "z"],
    ]  # fmt: skip


def test_an_axis_of_typed_values_gives_the_cells_of_the_same_axis_as_text():
    values = {"robot": ["macro", "mini"], "noise.position": ["1mrad", 0.002], "seed": range(3), "f": [Path("a b")]}
    typed = sweep_overrides([], values)
    texts = [each if isinstance(each, str) else each.typed for each in typed]
    plans = [plan_sweep(each) for each in (typed, texts)]
    assert list(plans[0].axes()) == list(plans[1].axes())
    assert [plan.overrides(11) for plan in plans] == [("robot=mini", "noise.position=0.002", "seed=2", "f='a b'")] * 2


def test_a_text_in_an_axis_is_no_interpolation():
    (axis,) = sweep_overrides([], {"a": ["${oc.env:HOME}"]})
    assert axis.typed == r"a='\${oc.env:HOME}'"
    with pytest.raises(ConfigError, match="calls a function"):
        plan_sweep([axis])


def test_ranges_of_a_tuning():
    assert tuning_overrides([], {"a__b": (5, 50), "c": [1, 2], "d": "tag(log, interval(1,9))"}) == [
        "a.b=interval(5,50)", "c=[1,2]", "d=tag(log, interval(1,9))",
    ]  # fmt: skip


def test_all_problems_are_told_at_once():
    with pytest.raises(ConfigError) as raised:
        sweep_overrides([3], {"a": object(), "b c": 1, "d": [], "e": [{1, 2}], "f": {"g h": 1}})
    told = raised.value.problems
    assert len(told) == 6
    assert "3 is not a valid override" in told[0]
    assert "a: cannot be written as an override" in told[1]
    assert "'b c' is not a key" in told[2]
    assert "d: is swept over no value" in told[3]
    assert "e: cannot be written" in told[4]
    assert "f: cannot be written as an override: 'g h' is not the name of a key" in told[5]
