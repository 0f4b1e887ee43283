"""Payloads that change on the way."""

import numpy as np
import pytest
from support.arms import checked

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders
from runner.sweeps.job import run

ENGINES = ("rk4", "bullet", "mujoco")
HELD = ("robot=macro", "controller=computed_torque", "trajectory=joint_quintic", "trajectory.duration=0.5")
PICKED_UP = "robot.payload.schedule=[{at: 0.5, mass: 2.0}]"


def traced(*overrides):
    config = checked(*overrides)
    loop = assemble(config)
    try:
        return config, simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0))
    finally:
        loop.close()


@pytest.mark.parametrize("plant", ENGINES)
def test_until_the_change_the_run_is_the_one_without(plant):
    _, without = traced(*HELD, f"plant={plant}", "duration=1")
    _, changed = traced(*HELD, f"plant={plant}", "duration=1", PICKED_UP)
    row = int(np.searchsorted(without.t, 0.5 + 1e-9))
    np.testing.assert_allclose(changed.q[:row], without.q[:row], atol=1e-12)
    assert np.abs(changed.q[row + 20] - without.q[row + 20]).max() > 1e-5


@pytest.mark.parametrize("plant", ENGINES)
def test_at_rest_the_error_is_what_the_new_weight_asks_of_the_law(plant):
    # M(q) w^2 (q_d - q) + G(q) holds the arm with its payload: G'(q).
    config, trace = traced(*HELD, f"plant={plant}", "duration=3", PICKED_UP)
    q, q_d = trace.q[-1], config.path.sample_joints(trace.t[-1:])[0, 0]
    nominal, ((_, loaded),) = config.arm.model, config.loaded
    omega = config.controller.natural_frequency
    asked = omega**2 * nominal.mass_matrix(q) @ (q_d - q) + nominal.gravity_torque(q)
    np.testing.assert_allclose(asked, loaded.model.gravity_torque(q), rtol=1e-5, atol=1e-9)
    assert np.abs(q_d - q).max() > 1e-3


def test_the_arm_goes_on_by_the_loaded_arm_s_dynamics():
    config, trace = traced(*HELD, "plant=rk4", "duration=0.6", "controller.period=1e-4", PICKED_UP)
    k = int(np.searchsorted(trace.t, 0.5 - 1e-9))
    acceleration = (trace.dq[k + 1] - trace.dq[k]) / 1e-4
    ((_, loaded),) = config.loaded
    expected = loaded.model.forward_dynamics(trace.q[k], trace.dq[k], trace.tau[k])
    np.testing.assert_allclose(acceleration, expected, atol=1e-3 * np.abs(expected).max())
    before = config.arm.model.forward_dynamics(trace.q[k - 1], trace.dq[k - 1], trace.tau[k - 1])
    np.testing.assert_allclose((trace.dq[k] - trace.dq[k - 1]) / 1e-4, before, atol=1e-3 * np.abs(expected).max())


def test_a_change_between_ticks_comes_with_the_next_tick():
    at = [traced(*HELD, "plant=rk4", "duration=0.6", f"robot.payload.schedule=[{{at: {t}, mass: 2}}]")[1].q
          for t in (0.4991, 0.5, 0.5001)]  # fmt: skip
    np.testing.assert_array_equal(at[0], at[1])
    assert np.abs(at[1] - at[2]).max() > 0.0


def test_what_is_put_down_again_leaves_no_error():
    config, trace = traced(
        *HELD, "plant=rk4", "duration=4", "robot.payload.schedule=[{at: 0.5, mass: 2},{at: 1.5, mass: 0}]"
    )
    error = config.path.sample_joints(trace.t)[:, 0] - trace.q
    assert np.abs(error[trace.t < 1.5]).max() > 1e-3
    assert np.abs(error[-1]).max() < 1e-9


def test_behind_servos_and_with_friction():
    friction = ("plant.friction.viscous=0.5", "plant.friction.coulomb=0.2")
    _, trace = traced(*HELD, "plant=rk4", "duration=1.5", PICKED_UP, *friction)
    assert trace.failure is None
    servo = ("robot=xarm7", "controller=differential_inverse_kinematics", "plant=rk4", "duration=1.5", PICKED_UP)
    _, loaded = traced(*servo)
    _, free = traced(*servo[:-1])
    row = int(np.searchsorted(free.t, 0.5 + 1e-9))
    np.testing.assert_array_equal(loaded.q[:row], free.q[:row])
    assert 1e-5 < np.abs(loaded.q[-1] - free.q[-1]).max() < 0.1


def test_stages_that_ride_carry_it_too():
    _, trace = traced("robot=combined", "plant=rk4", "duration=0.8", "trajectory=quintic", PICKED_UP)
    assert trace.failure is None


def test_repetitions_are_run_one_by_one_and_begin_alike(tmp_path):
    made = run(*HELD, "plant=rk4", "duration=0.7", PICKED_UP, "repetitions=2", f"outputs={tmp_path}")
    values = made.metrics["max_joint_error"].values
    assert values[0] == values[1]


@pytest.mark.parametrize(
    ("overrides", "problem"),
    [
        (["robot.payload.schedule=[{at: 1, mass: 1},{at: 1, mass: 2}]"], "schedule: must run forward in time"),
        (["robot.payload.schedule=[{at: 0, mass: 1}]"], "schedule.0.at: must be above 0; found 0"),
        (["robot.payload.schedule=[{at: 1, mass: -1}]"], "schedule.0.mass: must be 0 or more; found -1"),
        (["robot.payload.schedule=[{at: 1}]"], "schedule.0.mass: missing"),
        ([PICKED_UP, "robot=xarm7", "plant=kinematic"], "schedule: .* on the way of plant=kinematic"),
        ([PICKED_UP, "robot=meca500", "plant=rk4"], "schedule: .* where the tip touches something"),
    ],
)
def test_what_cannot_be_is_told(overrides, problem):
    with pytest.raises(ConfigError, match=f"robot.payload.{problem}"):
        checked(*overrides)


def test_the_rated_payload_is_compared_with_the_largest():
    config = checked("robot=xarm7", "plant=rk4", "robot.payload.schedule=[{at: 1, mass: 4}]")
    assert config.robot.burden == 4.0


def test_a_time_may_have_its_unit():
    config = checked("robot=macro", "robot.payload.schedule=[{at: 500ms, mass: 1}]")
    assert config.loaded[0][0] == 0.5
