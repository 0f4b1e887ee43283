"""Findings of the Meca500 report, evaluated alone: each condition of each is made to fail by a changed value."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import pytest

from runner.reporting.findings import Finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number
from runner.works.meca500.at_the_tip import tip_finding
from runner.works.meca500.calibration_studies import consistency_finding
from runner.works.meca500.contact import contact_finding
from runner.works.meca500.frequency_response import frequency_finding
from runner.works.meca500.gravity import identification_finding
from runner.works.meca500.gravity_orientations import orientations_finding
from runner.works.meca500.gravity_residual import residual_finding
from runner.works.meca500.hand_guiding import guiding_finding
from runner.works.meca500.inertials import inertials_finding
from runner.works.meca500.kinematics import kinematics_finding
from runner.works.meca500.limits import limits_finding
from runner.works.meca500.servo_walls import servo_wall_finding
from runner.works.meca500.stability_map import ideal_wall_finding
from runner.works.meca500.step_response import ideal_step_finding, servo_step_finding
from runner.works.meca500.tool_centre_point import shared_pose_finding, spread_finding
from runner.works.meca500.tool_direction import alignment_finding, direction_finding
from runner.works.meca500.wrist_sensor import reaction_finding

# What the whole runs gave. The thin plan of the other tests has short runs, on which conditions may fail.
MEASURED: dict[Callable[..., Finding], dict[str, float]] = {
    kinematics_finding: {
        "equations": 76,
        "right": 21,
        "mended": 18,
        "wrong": 24,
        "lost": 12,
        "names": 1,
        "cells": 28,
        "table": 1.415e-13,
        "without_2": 336.8,
        "without_6": 180,
        "transform_wrong": 0,
        "linear": 22,
        "linear_wrong": 1,
        "angular": 26,
        "angular_wrong": 21,
        "axes": 21,
    },
    partial(inertials_finding, "link5"): {"light": 100, "mass": 36.27, "gravity": 16.44, "tip": 2.006e-5},
    reaction_finding: {
        "count": 100,
        "force": 1.776e-15,
        "moment": 9.714e-17,
        "weight": 2.453,
        "weighed": 2.22e-15,
        "power": 2.502,
        "moving": 0.09406,
        "speed": 3.008,
        "fine": 0.08651,
    },
    spread_finding: {
        "exact": 7.686e-17,
        "wide_spread": 30,
        "wide": 7.246,
        "narrow_spread": 2.865,
        "narrow": 73.4,
        "power": -0.9827,
        "condition": 2,
        "wide_condition": 1.949,
        "singular": 0.04081,
        "wide_singular": 0.4226,
        "few_poses": 4,
        "few": 7.193,
        "many_poses": 20,
        "many": 5.519,
    },
    shared_pose_finding: {
        "wrong": 3.504,
        "right": 5.519,
        "together": 2.821,
        "poses": 20,
        "errors": 40,
        "nees": 12.23,
        "lower": 2.096,
        "upper": 4.091,
    },
    direction_finding: {
        "exact": 5.157e-12,
        "short_by": 5,
        "long_by": 50,
        "short": 1.698,
        "short_predicted": 1.661,
        "long": 0.1779,
        "long_predicted": 0.1746,
        "over": 20,
        "aside": 33.96,
    },
    alignment_finding: {"printed": 108.1, "described": 0},
    consistency_finding: {"inside": 15, "count": 15, "outside": 0, "level": 99, "chance": 1},
    identification_finding: {
        "exact": 1.184e-14,
        "mass": 0.3964,
        "mass_predicted": 0.4058,
        "theta": 0.5875,
        "theta_predicted": 0.5763,
        "r": 41.94,
        "r_predicted": 43.26,
        "interval": 95,
        "held": 95,
    },
    orientations_finding: {
        "few": 4,
        "best": 0.9535,
        "first": 1.396,
        "many": 32,
        "best_many": 0.288,
        "first_many": 0.3126,
        "spread": 22.92,
        "count": 16,
        "narrow": 7.313,
        "wide": 0.4058,
        "narrow_condition": 58.89,
        "wide_condition": 1.729,
    },
    residual_finding: {"force": 5.028, "moment": 0.1528, "force_noise": 35.52, "moment_noise": 0.866},
    ideal_step_finding: {"fast": 0.004712, "period": 16.7, "slow": 0.9947, "ticks": 0.008564, "late": 12.07},
    servo_step_finding: {"fast": 26.19, "give": 25.8, "apart": 0.3956, "slow": 20.13, "kept": 2.753, "shorter": 44.28},
    frequency_finding: {
        "fast": 0.001262,
        "slow": 0.01116,
        "period": 16.7,
        "off_fast": 7.534,
        "off_slow": 88.96,
        "half": 7.538,
        "highest": 24,
        "samples": 2.495,
        "servo": 20.2,
        "bound": 4,
        "most": 3.08,
    },
    tip_finding: {
        "law": 3.244e-18,
        "tool": 2.785e-16,
        "flange": 0.04736,
        "servo_law": 1.374e-18,
        "servo": 0.002603,
        "noisy": 2.697e-05,
    },
    contact_finding: {
        "softest": 1000,
        "stiffest": 1e05,
        "reading": 5.316e-06,
        "series": 0.04417,
        "first": 1.779,
        "softer": 0.9467,
    },
    ideal_wall_finding: {
        "right": 24,
        "count": 24,
        "nearest": 10,
        "least": 0.5,
        "most": 2,
        "period": 16.7,
        "bound": 1.088e04,
        "low": 1.007,
        "high": 1.135,
    },
    servo_wall_finding: {
        "right": 33,
        "count": 36,
        "above": 18,
        "bounced": 18,
        "nearest": 9.815,
        "wrong": 3,
        "saturated": 97.69,
        "calm": 10.17,
        "low": 0.818,
        "high": 3.398,
    },
    guiding_finding: {
        "travel": 58.31e-3,
        "damped": 0.8746,
        "pull": 0.8893,
        "left": 1.636e-08,
        "turned": 3.333e-16,
        "lab_pull": 0.8883,
        "lab_left": 7.311e-6,
        "lab_turned": 0.3862,
    },
    limits_finding: {"margin": 1.741e-10, "speed": 100, "change": 13.57, "told": 3, "count": 3},
}
CHANGES: tuple[Callable[[float], float | None], ...] = (
    lambda value: 1000.0 * value,
    lambda value: value / 1000.0,
    lambda value: -value,
    lambda value: value + 10.0,
    lambda value: value - 10.0,
)


def built(make: Callable[..., Finding], values: Mapping[str, float | None]) -> Finding:
    return make(**{name: Measured(f"the {name}", value) for name, value in values.items()})


def name_of(make: Callable[..., Finding]) -> str:
    return getattr(make, "func", make).__name__


cases = pytest.mark.parametrize("make", MEASURED, ids=name_of)


@cases
def test_it_holds_for_what_was_measured(make):
    found = built(make, MEASURED[make])
    assert found.holds, found.text


@cases
def test_each_condition_fails_for_a_changed_value(make):
    values = MEASURED[make]
    changed = [built(make, {**values, name: change(values[name])}) for name in values for change in CHANGES]
    for index, condition in enumerate(built(make, values).conditions):
        failed = [each for each in changed if not each.conditions[index].holds]
        assert failed, f"nothing refutes: {condition.text}"
        assert failed[0].title.startswith("No longer holds: ")


@cases
def test_a_missing_value_in_a_condition_is_told(make):
    values = MEASURED[make]
    missing = [built(make, {**values, name: None}) for name in values]
    assert any("has no value" in each.text for each in missing)
    for index, _ in enumerate(built(make, values).conditions):
        assert any(not each.conditions[index].holds for each in missing)


def test_the_rows_of_the_readme_are_what_was_measured():
    step, servo, ideal = (MEASURED[make] for make in (ideal_step_finding, servo_step_finding, ideal_wall_finding))
    wall, behind, tip = (MEASURED[make] for make in (contact_finding, servo_wall_finding, tip_finding))
    told = (
        f"within {number(step['fast'])} % of the peak on all axes at 1 ms, {number(step['slow'])} % at "
        f"{number(step['period'])} ms; joint servos add up to {number(servo['fast'])} % |",
        f"turns the law by {number(tip['law'], rounding=ROUNDING)} and",
        f"taken at the flange {number(tip['flange'])} rad |",
        f"read within {number(wall['reading'])} %; on ideal joints {ideal['right']} of {ideal['count']} runs",
        f"behind servos {behind['right']} of {behind['count']} |",
    )
    readme = Path("README.md").read_text()
    assert [words for words in told if words not in readme] == []
