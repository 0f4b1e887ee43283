"""Runs along motions of the joints: laws that follow joints, and laws that follow the tip."""

import numpy as np
import pytest
from support.physics import assert_order

from runner.assembly.assemble import assemble
from runner.metrics.summary import evaluate
from runner.simulation.loop import simulate
from runner.simulation.results import metric_context
from runner.simulation.sensors import make_encoders
from runner.sweeps.job import run

JOINTS = ("robot=macro", "trajectory=joint_quintic", "plant=rk4", "trajectory.duration=1", "duration=1.5")


def traced(config):
    loop = assemble(config)
    try:
        return simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0))
    finally:
        loop.close()


def test_computed_torque_follows_the_joints_and_not_the_tip(checked_config):
    # Of seven joints the tip's motion leaves one free, which the joints' does not.
    config = checked_config("robot=xarm7", *JOINTS[1:], "controller=computed_torque", "robot.armature=assumed")
    (loop,) = config.loops
    assert loop.follows_joints
    trace = traced(config)
    desired = config.path.sample_joints(trace.t)[:, 0]
    assert np.abs(trace.q - desired).max() < 2e-3
    assert evaluate(trace, metric_context(config))["max_joint_error"] < 2e-3


def test_under_an_exact_model_only_the_held_torque_leaves_an_error(checked_config):
    def largest(h):
        config = checked_config(*JOINTS, "controller=computed_torque", f"controller.period={h}")
        trace = traced(config)
        return np.abs(config.path.sample_joints(trace.t)[:, 0] - trace.q).max()

    assert_order([largest(0.002), largest(0.001)], 1, within=0.028)  # it is late by half a period


def test_the_arm_starts_at_the_first_posture(checked_config):
    posture = [0.3, 0.4, -0.2]
    for controller in ("computed_torque", "operational_space", "differential_inverse_kinematics"):
        more = (f"trajectory.start_configuration={posture}", f"controller={controller}")
        np.testing.assert_allclose(traced(checked_config(*JOINTS, *more)).q[0], posture, atol=1e-15)


@pytest.mark.parametrize("feedforward", ["true", "false"])
@pytest.mark.parametrize("gain", ["0", "100"])
def test_compiled_and_through_pinocchio_it_is_one_law(checked_config, monkeypatch, feedforward, gain):
    more = (f"controller.feedforward={feedforward}", f"controller.integral_gain={gain}")
    config = checked_config(*JOINTS, "controller=computed_torque", *more)
    whole = traced(config)
    monkeypatch.setattr("runner.assembly.assemble._find_commands", lambda *_: None)
    plain = traced(config)
    np.testing.assert_allclose(whole.q, plain.q, atol=1e-9)
    np.testing.assert_allclose(whole.tau, plain.tau, atol=1e-6)


def test_bullet_s_commands_are_compiled_too(checked_config, monkeypatch):
    config = checked_config(*JOINTS[:2], "plant=mujoco", *JOINTS[3:], "controller=computed_torque")
    compiled = traced(config)
    monkeypatch.setattr("runner.assembly.assemble._find_commands", lambda *_: None)
    np.testing.assert_allclose(compiled.q, traced(config).q, atol=1e-9)


def test_repetitions_together_are_those_one_by_one(tmp_path, checked_config):
    overrides = (*JOINTS, "controller=computed_torque", "noise.position=1e-4", "noise.distribution=uniform")
    made = run(*overrides, "repetitions=3", f"outputs={tmp_path}")
    config = checked_config(*overrides)
    for repetition, stored in enumerate(made.metrics["rms_joint_error"].values):
        loop = assemble(config, repetition)
        trace = simulate(loop, make_encoders(loop, config.noise, config.settings.seed, repetition))
        loop.close()
        assert evaluate(trace, metric_context(config))["rms_joint_error"] == stored


def test_paths_of_the_tip_have_no_joint_error(tmp_path):
    assert (
        "rms_joint_error" not in run("robot=macro", "trajectory=quintic", "duration=0.1", f"outputs={tmp_path}").metrics
    )


def test_a_tip_law_gets_the_tip_s_motion(checked_config):
    config = checked_config(*JOINTS, "controller=operational_space")
    assert not config.loops[0].follows_joints
    trace = traced(config)
    np.testing.assert_array_equal(trace.desired, config.path.sample(trace.t))
    assert np.abs(trace.error).max() < 2e-3
