"""Caveat of integration error: its thresholds, and the step that it names."""

import pytest

from runner.base.engines import has_pybullet
from runner.caveats.integration_error import ErrorEstimate, PlantError
from runner.caveats.plant_error import PlantStep, caveat_of
from runner.sweeps.job import run

OWN = PlantStep("bullet", 1e-3, 0.01, 0.02)
LIMIT = 0.1
PLANT = "bullet" if has_pybullet() else "mujoco"
CASE = ("experiment=thesis/figure_3_10", "repetitions=1", "noise=none", f"plant={PLANT}")


def error(**metrics):
    worth = {name: ErrorEstimate(1.0, difference, share) for name, (difference, share) in metrics.items()}
    return PlantError(0.01, largest=1e-3, at=0.5, end=1e-6, metrics=worth)


@pytest.mark.parametrize(
    ("difference", "share", "sprung"),
    [(3e-4, 0.2, True), (1e-4, 0.2, False), (3e-4, 0.05, False), (None, None, False)],
)
def test_it_is_sprung_by_a_share_of_a_length_that_matters(difference, share, sprung):
    found = caveat_of(error(max_tracking_error=(difference, share)), OWN, LIMIT)
    assert (found is not None) == sprung


def test_a_settling_time_and_a_torque_do_not_spring_it():
    assert caveat_of(error(settling_time=(0.5, 0.5), peak_torque=(30.0, 0.6)), OWN, LIMIT) is None


def test_the_worst_length_is_told_with_a_step_that_would_do():
    found = caveat_of(error(max_tracking_error=(1e-3, 0.2), rms_tracking_error=(1e-3, 0.5)), OWN, LIMIT)
    assert (found.rule, found.value) == ("plant_error", 0.5)
    assert found.text == (
        "the integration step of bullet, 0.001 s, contributes 50 % of rms_tracking_error: plant.step=0.000111111 would "
        "make it 10 % or less, or plant=rk4 would make it negligible"
    )


def test_motions_that_part_are_told_and_silenced_by_a_share_of_one():
    parted = PlantError(0.01, largest=1.1, at=1.3, end=2e-6, parted=0.7)
    assert caveat_of(parted, OWN, LIMIT).text == (
        "bullet in steps of 0.001 s and rk4 part at t = 0.7 s: their tips are 1.1 m apart at most, and 2e-06 m at the "
        "end; what is measured after that is one of several outcomes"
    )
    assert caveat_of(parted, OWN, 1.0) is None


@pytest.mark.parametrize(
    ("failure", "end"),
    [("diverged", "on rk4 the run fails: diverged"), ("", "where this run fails and that on rk4 does not")],
)
def test_a_failure_of_one_of_both_is_told(failure, end):
    parted = PlantError(0.01, largest=1e-3, at=0.7, end=1e-3, parted=0.7, failure=failure)
    assert caveat_of(parted, OWN, LIMIT).text.endswith(end)


def test_the_step_that_it_names_does(tmp_path):
    """Figure 3.10 without noise, in steps of a whole period."""
    outputs = f"outputs={tmp_path}"
    (caveat,) = [one for one in run(*CASE, "plant.step=0.005", outputs).caveats if one["rule"] == "plant_error"]
    assert caveat["value"] > LIMIT
    step = caveat["text"].partition("plant.step=")[2].partition(" ")[0]
    finer = run(*CASE, f"plant.step={1.0 / (100 * round(0.01 / float(step)))!r}", outputs)
    assert not [one for one in finer.caveats if one["rule"] == "plant_error"]
