"""Torque sensors in the joints: their errors, what is behind friction, and the observer that reads them."""

import numpy as np
import pytest
from support.arms import checked, last_of_each

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError
from runner.sensing.joint_torque import JointTorqueNoise, JointTorqueSensor
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders, make_joint_torque_sensor

LINE = ("robot=macro", "controller=computed_torque", "controller.period=0.002", "trajectory=joint_quintic",
        "plant.friction.coulomb=0.5", "plant.friction.viscous=0.2", "duration=2", "disturbance_observer.bandwidth=60",
        "disturbance_observer.torque=measured")  # fmt: skip


def found(*overrides):
    """r of the observer at the end of a run, and the trace."""
    config = checked(*last_of_each(*LINE, *overrides))
    closed = assemble(config)
    try:
        trace = simulate(
            closed, make_encoders(closed, config.noise, 0, 0), None, make_joint_torque_sensor(closed, config, 0)
        )
        return closed.loops[0].controller.state[:3], trace
    finally:
        closed.close()


def test_readings_have_the_errors_of_the_config():
    noise, bias = np.array([0.1, 0.0, 0.4]), np.array([0.0, -1.0, 2.0])
    sensor = JointTorqueSensor(20000, JointTorqueNoise(noise, bias), np.random.default_rng(1))
    errors = np.array([sensor.read(tick, np.full(3, 5.0)) - 5.0 for tick in range(20000)])
    np.testing.assert_allclose(errors.mean(axis=0), bias, atol=0.02)
    np.testing.assert_allclose(errors.std(axis=0), noise, rtol=0.03, atol=1e-12)
    longer = JointTorqueSensor(30000, JointTorqueNoise(noise, bias), np.random.default_rng(1))
    np.testing.assert_array_equal(longer.read(7, np.zeros(3)), sensor.read(7, np.zeros(3)))


@pytest.mark.parametrize("plant", ["rk4", "bullet", "mujoco"])
def test_friction_is_not_behind_the_sensors(plant):
    """Of an exact model the observer finds the friction where it takes commands, and nothing where it measures."""
    r, trace = found(f"plant={plant}", "joint_torque_sensor=ideal")
    assert trace.failure is None
    assert np.abs(r).max() < 1e-3
    friction = 0.5 * np.sign(trace.dq[-1]) + 0.2 * trace.dq[-1]
    assert np.abs(friction).min() > 0.5


def test_what_the_links_feel_is_found():
    """A payload that the law does not know of weighs on the joints, on top of the friction that is not seen."""
    r, trace = found("plant=rk4", "joint_torque_sensor=ideal", "robot.payload.mass=0.5", "mismatch.payload=-0.5",
                     "duration=5")  # fmt: skip
    with_load, without = (checked("robot=macro", "trajectory=goal", f"robot.payload.mass={m}") for m in (0.5, 0.0))
    weight = without.arm.model.gravity_torque(trace.q[-1]) - with_load.arm.model.gravity_torque(trace.q[-1])
    np.testing.assert_allclose(r, weight, atol=1e-3 * np.abs(weight).max())


def test_a_bias_is_found_as_a_torque_that_is_not_there():
    r, _ = found("plant=rk4", "joint_torque_sensor.noise=0", "joint_torque_sensor.bias=[0.3,0,-0.2]")
    np.testing.assert_allclose(r, [-0.3, 0.0, 0.2], atol=1e-3)


def test_noise_follows_from_seed_and_repetition_and_changes_no_other_draw():
    runs = [found("plant=rk4", "joint_torque_sensor.noise=0.2", "noise=thesis")[1].q for _ in range(2)]
    np.testing.assert_array_equal(*runs)
    quiet = found("plant=rk4", "joint_torque_sensor=ideal", "noise=thesis")[1].q
    assert np.abs(quiet - runs[0]).max() > 0.0


def test_each_loop_reads_the_mean_since_its_last_tick(simulated):
    line = ("robot=combined", "controller=macro_mini", "disturbance_observer.bandwidth={macro: 30, mini: 100}",
            "disturbance_observer.torque=measured", "joint_torque_sensor=ideal", "trajectory=quintic", "plant=rk4",
            "plant.friction.coulomb=0.1", "duration=0.5")  # fmt: skip
    config = checked(*line)
    closed = assemble(config)
    trace = simulate(
        closed, make_encoders(closed, config.noise, 0, 0), None, make_joint_torque_sensor(closed, config, 0)
    )
    closed.close()
    assert trace.failure is None
    assert all(np.isfinite(loop.controller.state).all() for loop in closed.loops)


REFUSED = {
    ("disturbance_observer.torque=measured",): "take joint_torque_sensor=ideal",
    ("joint_torque_sensor.noise=[1,2]",): "joint_torque_sensor.noise: 2 values for 3 joints",
    ("joint_torque_sensor=ideal", "joint_torque_sensor.bias=[1]"): "joint_torque_sensor.bias: 1 values for 3 joints",
    ("joint_torque_sensor.noise=-1",): "0 or more",
}


@pytest.mark.parametrize("given", REFUSED)
def test_what_is_refused(given):
    with pytest.raises(ConfigError, match=REFUSED[given].replace("[", r"\[")):
        checked(*LINE, *given)
