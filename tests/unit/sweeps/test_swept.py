"""Axes of a command line: values, options and empty axes."""

import pytest
from support.grids import plan_sweep

from runner.base.errors import ConfigError


def keys(*arguments):
    return plan_sweep(arguments)._keys


@pytest.mark.parametrize(
    ("argument", "values"),
    [
        ("seed=3", [3]),
        ("seed=0,1", [0, 1]),
        ("seed=range(0,3)", [0, 1, 2]),
        ("noise.position=1e-4,null", [1e-4, None]),
        ("robot.goal=[0,0,1],[0,1,1]", [[0, 0, 1], [0, 1, 1]]),
        ("robot.name='a,b',c", ["a,b", "c"]),
        ("trajectory.goal=${robot.goal},null", ["${robot.goal}", None]),
    ],
)
def test_values_are_read_as_hydra_reads_them(argument, values):
    (key,) = keys(argument)
    assert list(key.values) == values
    assert not key.option
    for number, value in enumerate(values):
        (again,) = keys(key.override(number).removeprefix("++"))
        assert again.values == [value]
        assert plan_sweep([key.override(number)]).composed(0).resolved


def test_options_of_groups_are_told_from_values():
    assert [key.option for key in keys("robot=macro,mini", "noise={position:1}", "seed=1", "~noise", "~seed")] == [
        True,
        False,
        False,
        True,
        False,
    ]
    assert "macro" in keys("robot=glob(m*)")[0].values


def test_the_last_values_of_a_key_count():
    (key,) = keys("seed=1,2", "seed=3")
    assert key.values == [3]


@pytest.mark.parametrize("argument", ["seed=range(3,3)", "robot=glob(q*)"])
def test_an_empty_axis_is_named(argument):
    name = argument.partition("=")[0]
    with pytest.raises(ConfigError, match=f"{name}: is swept over no value; give one or more"):
        keys(argument)


def test_what_is_no_override_is_said():
    with pytest.raises(ConfigError, match="'seed=0,1,,2' is not a valid override"):
        keys("seed=0,1,,2")


@pytest.mark.parametrize("argument", ["seed=range(0,100000000)", "seed=range(0,inf)", "seed=range(1e300)"])
def test_too_many_cells_are_refused_before_they_are_written_out(argument):
    with pytest.raises(ConfigError, match=r"cells; allowed: up to 10,000,000"):
        plan_sweep([argument])
    with pytest.raises(ConfigError, match=r"the sweep has 11,000,000 cells"):
        plan_sweep(["seed=range(0,1100)", "noise.position=range(0,10000)"])


def test_quantities_are_an_axis_of_numbers_in_si():
    sweep = plan_sweep(["robot=macro", "controller.period=5ms,0.02,30 ms", "seed=0,1"])
    numbers = plan_sweep(["robot=macro", "controller.period=0.005,0.02,0.03", "seed=0,1"])
    assert [sweep.overrides(cell) for cell in range(6)] == [numbers.overrides(cell) for cell in range(6)]
    assert list(sweep.axes()) == list(numbers.axes())
    assert [sweep.composed(cell).resolved for cell in range(6)] == [
        numbers.composed(cell).resolved for cell in range(6)
    ]


def test_a_quantity_that_does_not_fit_stays_as_typed():
    sweep = plan_sweep(["robot=macro", "controller.period=5ms,5mm"])
    assert sweep.overrides(1) == ("robot=macro", "controller.period=5mm")
    assert sweep.composed(1).resolved["controller"]["period"] == "5mm"
    assert sweep.composed(0).resolved["controller"]["period"] == 0.005


@pytest.mark.parametrize(
    ("argument", "values"),
    [
        ("noise.position=range(0.1,0.4,0.1)", [0.1, 0.2, 0.3]),
        ("noise.position=range(0,1,0.1)", [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]),
        ("noise.position=range(0.3,0,-0.1)", [0.3, 0.2, 0.1]),
        ("noise.position=range(1e-4,5e-4,1e-4)", [1e-4, 2e-4, 3e-4, 4e-4]),
        ("noise.position=range(1.0,3)", [1.0, 2.0]),
        ("controller.period=range(5ms,20ms,5ms)", [0.005, 0.01, 0.015]),
        ("controller.period=range(0.1,0.05,0.01)", None),
        ("seed=range(0,2.5)", [0, 1, 2]),
        ("seed=range(5,0,-2)", [5, 3, 1]),
    ],
)
def test_ranges_are_counted_in_decimal_without_their_stop(argument, values):
    if values is None:
        with pytest.raises(ConfigError, match="is swept over no value"):
            keys(argument)
        return
    (key,) = keys(argument)
    assert repr(list(key.values)) == repr(values)


def test_whole_numbers_are_not_written_out():
    assert [keys(text)[0].values for text in ("seed=range(0,1000000,7)", "seed=range(9,0.5,-2)")] == [
        range(0, 1_000_000, 7),
        range(9, 0, -2),
    ]


@pytest.mark.parametrize(
    ("argument", "values"),
    [
        ("controller.period=sort(20ms,5ms,10ms)", [0.005, 0.01, 0.02]),
        ("controller.period=sort(20ms,0.005,10ms,reverse=true)", [0.02, 0.01, 0.005]),
        ("controller.period=sort(choice(20ms,5ms))", [0.005, 0.02]),
        ("robot.name=sort(30m,4m)", ["30m", "4m"]),  # names, not lengths
        ("seed=sort(10,9)", [9, 10]),
    ],
)
def test_sorted_values_are_numbers(argument, values):
    assert keys(argument)[0].values == values


@pytest.mark.parametrize(
    "argument", ["controller.period=shuffle(20ms,0.01)", "controller.period=shuffle(range(10ms,30ms,10ms))"]
)
def test_shuffled_values_are_numbers(argument):
    assert sorted(keys(argument)[0].values) == [0.01, 0.02]


def test_a_unit_that_does_not_fit_is_not_sorted():
    with pytest.raises(ConfigError, match=r"controller\.period: must be a number, or one with a unit of s"):
        keys("controller.period=sort(5ms,5mm)")


@pytest.mark.parametrize(
    "argument", ["seed=range(0,1,0)", "seed=range(0,nan)", "seed=range(0,-inf)", "seed=range(nan,1,0.1)"]
)
def test_a_range_has_a_step_and_finite_ends(argument):
    with pytest.raises(
        ConfigError, match=r"seed: the (step of a range must not be 0|ends and the step of a range must be)"
    ):
        keys(argument)
