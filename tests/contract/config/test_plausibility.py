"""Bounds on absurd numbers: shipped configs pass, values beyond a bound are refused by key."""

import pytest

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.compose.files import group_options
from runner.schema.model import absurd


@pytest.mark.parametrize("robot", group_options("robot"))
def test_nothing_of_ours_is_absurd(robot):
    assert list(absurd("", compose([f"robot={robot}"]).resolved)) == []


@pytest.mark.parametrize(
    "value", [0, 0.0, 1e-12, -1e12, 10**17, True, None, "x" * 4096, [6.1e-17, 1.0], float("inf"), float("nan")]
)
def test_what_an_experiment_may_need_passes(value):
    assert list(absurd("a", {"b": value})) == []


@pytest.mark.parametrize(
    ("value", "problem"),
    [
        (1e300, "a.b: must lie between 1e-12 and 1e+12 in magnitude; found 1e+300"),
        (-5e-324, "a.b: must lie between 1e-12 and 1e+12 in magnitude; found -4.94066e-324"),
        ([1.0, {"c": 2e12}], "a.b.1.c: must lie between 1e-12 and 1e+12 in magnitude; found 2e+12"),
        (10**400, "a.b: must be a whole number of at most 18 digits; found 1000"),
        pytest.param(10**5000, "a.b: must be a whole number of at most 18 digits; found a value too large", id="huge"),
        ("x" * 5000, "a.b: must have at most 4096 characters; found 'xxx"),
    ],
)
def test_what_none_needs_is_told_by_its_key(value, problem):
    (found,) = absurd("a", {"b": value})
    assert found.startswith(problem)
    assert len(found) < 300


@pytest.mark.parametrize(
    ("robot", "override", "problem"),
    [
        (
            "macro",
            "plant.step=1e-12",
            "plant.step: 1e-12 s are 1e+10 steps in controller.period, 0.01 s; allowed: up to ",
        ),
        ("macro", "plant.step=1e-13", "plant.step: must lie between 1e-12 and 1e+12"),
        ("macro", "robot.natural_frequency=1e200", "robot.natural_frequency: must lie between"),
        ("xarm7", "controller.damping=1e300", "controller.damping: must lie between"),
        ("macro", "controller.period=5e-324", "controller.period: must lie between"),
        (
            "macro",
            "plant.computation.delay=1000000000",
            "plant.computation.delay: 1000000000 ticks found; allowed: up to",
        ),
        (
            "macro",
            f"robot.torque_limit=1{'0' * 400}",
            "robot.torque_limit: must be a whole number of at most 18 digits",
        ),
        ("combined", f"controller.period.macro=1{'0' * 400}", "controller.period.macro: must be a whole number"),
        ("macro", "robot.masses.link3=1e300", "robot.masses.link3: must lie between"),
        ("macro", f"robot.name={'x' * 201}", "robot.name: must have at most 200 characters; found 'xxx"),
    ],
)
def test_absurd_numbers_are_refused_before_anything_runs(robot, override, problem):
    with pytest.raises(ConfigError) as raised:
        validate(compose([f"robot={robot}", override]))
    assert any(found.startswith(problem) for found in raised.value.problems)


def test_so_are_those_of_a_calibration(cli):
    ending = cli("calibrate", "wrist_sensor.mass=1e300")
    assert (ending.code, "wrist_sensor.mass: must lie between" in ending.err) == (2, True)
