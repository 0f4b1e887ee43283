"""Runs with motors whose torque falls with the speed: terminal speed, braking, compiled loops, and what is counted."""

from dataclasses import replace

import numpy as np
import pytest

from runner.base.errors import ConfigError
from runner.metrics.summary import measure
from runner.simulation.loop import simulate
from runner.simulation.results import metric_context
from runner.simulation.sensors import make_encoders

SPINNING = ("robot=planar", "gravity=0", "controller=held_torques", "controller.torques=[1000,0]",
            "controller.period=5ms", "trajectory=goal", "plant.friction.viscous=[20,3]", "duration=8",
            "torque_limits.max=100", "torque_limits.no_load_speed=4")  # fmt: skip
MOVING = ("robot=macro", "controller=computed_torque", "trajectory=quintic", "trajectory.duration=0.6", "duration=0.8",
          "torque_limits.max=60", "torque_limits.no_load_speed=[2.5,null,3]")  # fmt: skip


@pytest.mark.costs(2)
@pytest.mark.parametrize("plant", ["rk4", "bullet", "mujoco"])
def test_under_viscous_load_it_ends_at_the_speed_where_torque_and_load_meet(simulated, plant):
    """max (1 - w / w0) = b w, with the second link flung out along the first."""
    trace = simulated(*SPINNING, f"plant={plant}", *(["plant.step=5ms"] if plant != "rk4" else []))
    speed = 100.0 / (20.0 + 100.0 / 4.0)
    assert trace.dq[-1, 0] == pytest.approx(speed, rel=1e-4)
    assert trace.dq[-1, 1] == pytest.approx(0.0, abs=1e-3)
    assert trace.tau[-1, 0] == pytest.approx(100.0 * (1.0 - speed / 4.0), rel=1e-4)


def test_it_brakes_with_the_whole_torque(simulated):
    trace = simulated(*MOVING, "plant=rk4")
    free = np.array([2.5, np.inf, 3.0])
    driving = 60.0 * np.maximum(0.0, 1.0 - np.abs(trace.dq) / free)
    drives = (trace.tau * trace.dq > 0.0) | (trace.tau == 0.0)
    assert (np.abs(trace.tau) <= 60.0).all()
    assert (np.abs(trace.tau)[drives] <= driving[drives] + 1e-12).all()
    assert (np.abs(trace.tau)[~drives] > driving[~drives] + 1.0).any()
    np.testing.assert_allclose(trace.limits, np.where(drives, driving, 60.0), atol=1e-12)


@pytest.mark.parametrize("more", [("robot=macro",), ("noise=thesis", "plant.computation.delay=1")])
def test_compiled_loops_and_a_run_compiled_as_a_whole_limit_alike(closed_loop, checked_config, simulated, more):
    given = (*MOVING, "plant=rk4", *more)
    loop, config = closed_loop(*given), checked_config(*given)
    assert loop.compiled is not None
    each = [simulate(made, make_encoders(made, config.noise, 0, 0)) for made in (loop, replace(loop, compiled=None))]
    whole = simulated(*given)
    for other in (each[1], whole):
        np.testing.assert_allclose(other.tau, each[0].tau, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(other.limits, each[0].limits, rtol=1e-9, atol=1e-9)
    assert (np.abs(whole.tau) >= whole.limits * (1.0 - 1e-12)).any()


def test_a_torque_held_by_a_slower_loop_keeps_its_limit(simulated):
    given = ("robot=combined", "controller=macro_mini", "trajectory=quintic", "trajectory.duration=0.4", "duration=0.4",
             "plant=rk4", "torque_limits.max={macro: 40, mini: 2}",
             "torque_limits.no_load_speed={macro: 2, mini: 6}")  # fmt: skip
    trace = simulated(*given)
    assert (np.abs(trace.tau) <= trace.limits * (1.0 + 1e-12)).all()
    assert (np.abs(trace.tau) >= trace.limits * (1.0 - 1e-12))[:, :3].any()


def test_the_metric_and_the_caveat_count_the_limit_that_applied(simulated, checked_config):
    config = checked_config(*MOVING, "plant=rk4")
    trace = simulated(*MOVING, "plant=rk4")
    metrics = measure(trace[None], metric_context(config))
    at_limit = (np.abs(trace.tau) >= trace.limits * (1.0 - 1e-12))[:-1]
    assert metrics["saturation_fraction"] == pytest.approx(at_limit.any(axis=1).mean())
    assert metrics["saturation_fraction_q1"] == pytest.approx(at_limit[:, 0].mean())
    assert at_limit[:, 0].mean() > (np.abs(trace.tau[:-1, 0]) >= 60.0 * (1.0 - 1e-12)).mean()


def test_the_caveat_names_the_limit_at_rest(cli):
    ending = cli(*MOVING, "plant=rk4", "torque_limits.no_load_speed=2.5rad/s")
    assert ending.code == 0, ending.err
    assert "joint q2 is at its torque limit, 60 N m at rest, in" in ending.err


@pytest.mark.parametrize("value", ["0", "-1", "[1,2,0]", "fast", "{macro: 1}"])
def test_a_no_load_speed_that_is_none_is_refused(checked_config, value):
    with pytest.raises(ConfigError, match=r"torque_limits.no_load_speed"):
        checked_config("robot=macro", "torque_limits.max=60", f"torque_limits.no_load_speed={value}")


def test_it_needs_a_torque_limit(checked_config):
    with pytest.raises(ConfigError, match=r"no_load_speed: needs a torque limit; none for q1, q2, q3"):
        checked_config("robot=macro", "torque_limits.no_load_speed=2")


@pytest.mark.parametrize(
    "more",
    [
        ("plant=rk4_flexible", "controller=joint_pd"),
        ("plant=bullet", "controller=differential_inverse_kinematics", "plant.servo.stiffness=20000"),
        ("plant=mujoco", "controller=operational_space"),
    ],
)
def test_every_plant_with_torques_has_such_motors(simulated, more):
    trace = simulated(*MOVING, *more)
    assert trace.failure is None
    size, limits = np.abs(trace.tau)[:-1], trace.limits[:-1]
    assert (size <= limits * (1.0 + 1e-12) + 1e-12).all()
    assert (size >= limits * (1.0 - 1e-12)).any()
