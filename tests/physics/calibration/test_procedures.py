"""Calibrations on the arm: its configurations, its result without noise, and its uncertainty with noise."""

import numpy as np
import pytest

from runner.base.errors import ConfigError
from runner.calibration.weighing import even_postures
from runner.config.compose.compose import compose
from runner.simulation.calibration import LEVEL, judge
from runner.simulation.calibration_config import validate_calibration

KINDS = ("tool_centre_point", "tool_direction", "gravity")
EXACT = ("calibration.repeatability=0", "wrist_sensor.noise=[0,0,0,0,0,0]", "wrist_sensor.resolution=[0,0,0,0,0,0]")
WIDE = ("calibration.posture=[0,0.2,0.3,0,1.2,0]", "calibration.spread=0.5")


def checked(*overrides):
    return validate_calibration(compose(overrides, root="calibrate"))


def procedure(*overrides):
    return checked(*overrides).procedure


def repeat(done, repetition=0):
    return done.repeat(np.random.default_rng([0, repetition]))


@pytest.mark.parametrize("overrides", [(), ("calibration.poses=3",), (*WIDE, "calibration.poses=9")])
def test_the_tip_stays_at_one_point_inside_the_joint_limits(overrides):
    config = checked(*overrides)
    postures, model = config.procedure.postures, config.arm.model
    tips = model.tip_positions(postures)
    posture = config.resolved["calibration"]["posture"]
    middle = config.arm.home if posture is None else np.array(posture)
    np.testing.assert_allclose(tips, np.tile(model.tip_position(middle), (len(tips), 1)), atol=1e-11)
    assert model.limit_margins(postures).min() > 0.0


def test_the_flange_is_tilted_by_the_spread_all_around():
    config = checked(*WIDE, "calibration.poses=5")
    model = config.arm.model
    central = model.tip_pose(np.array([0, 0.2, 0.3, 0, 1.2, 0]))[:3, :3]
    axes = np.array([(central.T @ model.tip_pose(q)[:3, :3])[:, 2] for q in config.procedure.postures])
    np.testing.assert_allclose(axes[:, 2], np.cos(0.5), atol=1e-11)
    np.testing.assert_allclose(axes[:, :2].sum(axis=0), 0.0, atol=1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_without_noise_the_truth_is_found(kind):
    done = procedure(f"calibration={kind}", *EXACT)
    outcome = repeat(done)
    np.testing.assert_allclose(outcome.estimates, done.truth, rtol=1e-9, atol=1e-10)
    assert np.abs(outcome.errors).max() < 1e-9
    assert not outcome.covariance.any()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [0, 1])
def test_errors_are_as_large_as_predicted(kind, seed):
    done = procedure(f"calibration={kind}")
    outcomes = [done.repeat(np.random.default_rng([seed, repetition])) for repetition in range(40)]
    judged = judge(outcomes)
    assert judged["holds"]
    assert judged["level"] == LEVEL
    assert np.mean(judged["values"]) == pytest.approx(judged["mean"])


def test_weighing_postures_lie_inside_the_joint_limits_and_are_spread_as_far_as_wanted():
    config = checked("calibration=gravity", "calibration.spread=0.8", "calibration.orientations=6")
    model, postures = config.arm.model, config.procedure.postures
    assert model.limit_margins(postures).min() > 0.0
    vertical = model.tip_pose(config.arm.home)[2, :3]
    assert min(model.tip_pose(q)[2, :3] @ vertical for q in postures) >= np.cos(0.8)


def test_the_choice_by_conditioning_knows_more_than_the_first_ones():
    best, first = (
        repeat(procedure("calibration=gravity", f"calibration.choice={choice}", "calibration.orientations=5"))
        for choice in ("best", "first")
    )
    assert best.measures["condition_force"] < first.measures["condition_force"]
    assert best.covariance[0, 0] < first.covariance[0, 0]


def test_even_postures_fill_the_joint_limits(meca500):
    lower, upper = np.clip(meca500.position_limits, -np.pi, np.pi)
    postures = even_postures(meca500, 1000)
    assert (postures > lower).all()
    assert (postures < upper).all()
    share = (postures - lower) / (upper - lower)
    np.testing.assert_allclose(share.mean(axis=0), 0.5, atol=0.01)
    np.testing.assert_allclose(share.var(axis=0), 1.0 / 12.0, atol=0.003)
    np.testing.assert_array_equal(even_postures(meca500, 10), postures[:10])


def test_a_low_pass_is_waited_for():
    done = procedure("calibration=gravity", *EXACT, "wrist_sensor.low_pass=30", "calibration.samples=1")
    np.testing.assert_allclose(repeat(done).estimates, done.truth, rtol=1e-6)


def test_a_drifting_bias_is_an_error_that_the_covariance_does_not_know():
    drifting = procedure("calibration=gravity", "wrist_sensor.drift=[0.5,0.5,0.5,0,0,0]")
    assert not judge([repeat(drifting, k) for k in range(20)])["holds"]


def test_what_compensation_leaves_is_nothing_for_an_exact_sensor_and_grows_with_noise():
    quiet, noisy = (repeat(procedure("calibration=gravity", *overrides)).measures for overrides in (EXACT, ()))
    assert quiet["residual_force"] < 1e-12
    assert quiet["residual_moment"] < 1e-12
    assert 1e-4 < noisy["residual_force"] < 0.05


def test_an_overloaded_sensor_saturates_and_says_so():
    done = procedure("calibration=gravity", "robot.tool.mass=3")
    outcome = repeat(done)
    assert any("beyond the sensor's range of 20 N; its reading stayed there" in message for message in outcome.messages)
    assert abs(outcome.errors[5]) > 0.1  # the bias takes up what the range cuts off
    assert not repeat(procedure("calibration=gravity")).messages


def test_equal_generators_give_equal_outcomes():
    done = procedure("calibration=gravity")
    np.testing.assert_array_equal(repeat(done, 3).estimates, repeat(done, 3).estimates)
    assert (repeat(done, 3).estimates != repeat(done, 4).estimates).all()


@pytest.mark.parametrize(
    ("overrides", "reason"),
    [
        (("calibration.poses=2",), "calibration.poses: 2 poses; a tool centre point needs 3 or more"),
        (("calibration.spread=0.001",), r"too much alike: none is turned by more than .*condition number 2"),
        (("calibration=gravity", "calibration.orientations=2"), "weighing a tool needs 3 or more"),
        (
            ("calibration=gravity", "calibration.spread=0.15", "calibration.candidates=20000"),
            r"condition numbers [\d.e+]+ \(force\) and .*; allowed: up to 100. Gravity turns by",
        ),
        (("calibration=tool_direction", "calibration.shorter=0.00002"), "a direction needs 5 times that"),
    ],
)
def test_what_cannot_be_told_apart_is_refused_with_the_reason(overrides, reason):
    with pytest.raises(ConfigError, match=reason):
        repeat(procedure(*overrides))


def test_readings_are_counted_before_they_are_drawn():
    many = procedure("calibration=gravity", "calibration.samples=100000")
    with pytest.raises(ConfigError, match="calibration: it has 1,600,000 readings; allowed: up to 1,000,000"):
        repeat(many)
    with pytest.raises(ConfigError, match=r"calibration.candidates: must .* 100000"):
        procedure("calibration=gravity", "calibration.candidates=100001")
