"""Torques for an acceleration and a force of the tip, against forward dynamics."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

from runner.assembly.assemble import assemble
from runner.controllers.force.tip_force import TipForce, TipForceConfig, find_force_task
from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyLaw
from runner.controllers.torque_law import PinocchioArm
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_sensors


def law(**changes):
    numbers = {
        "natural_frequency": 30.0,
        "damping_ratio": 1.0,
        "gravity_compensation": True,
        "feedforward": True,
        "null_space_frequency": 30.0,
        "max_tip_speed": None,
        "singularity_damping": 0.0,
    }
    return WholeBodyLaw(**(numbers | changes))


def states(robot, count=20):
    """Return random states and references."""
    draw = np.random.default_rng(0)
    return [
        (*draw.uniform(-1.0, 1.0, (2, robot.model.nq)), draw.uniform(-1.0, 1.0, (3, 3)), draw.uniform(-5.0, 5.0, 3))
        for _ in range(count)
    ]


@pytest.fixture(scope="module")
def three_stages(checked_config):
    return checked_config("robot=macro_mini_mini").arm


class Parameters(NamedTuple):
    law: Any
    gravity: Any
    force: Any


class Pushing(TipForce):
    """A law that asks for F* and a given force, and keeps the motion of the tip."""

    def command(self, backend, parameters, tip, state):
        self.tip = tip
        return tip.asked, parameters.force, state

    def with_force(self, force):
        return self.with_parameters(force=force)


def pushing(robot, stages="whole", rate=30.0):
    by_stage = {"natural_frequency": 30.0, "damping_ratio": 1.0, "period": 1e-3}
    given = {name: dict.fromkeys(robot.stage_names, value) for name, value in by_stage.items()}
    given |= {
        "gravity_compensation": True,
        "feedforward": True,
        "singularity_damping": 0.0,
        "null_space_frequency": rate,
    }
    task = find_force_task(TipForceConfig(actuated_stages=stages, **given), robot)
    return Pushing(task, Parameters(task.law.parameters, robot.model.gravity, np.zeros(3)))


def test_without_a_force_it_is_the_law_of_the_whole_body(combined):
    tip, whole = pushing(combined), WholeBody(combined.model, law(), combined.home)
    for q, dq, reference, _ in states(combined):
        np.testing.assert_array_equal(tip.torque(0.0, q, dq, reference), whole.torque(0.0, q, dq, reference))


def test_the_tip_gets_the_acceleration_asked_and_that_of_the_force(three_stages):
    model = three_stages.model
    for q, dq, reference, force in states(three_stages):
        tip = pushing(three_stages).with_force(force)
        ddq = model.forward_dynamics(q, dq, tip.torque(0.0, q, dq, reference))
        step = 1e-6  # dJ/dt dq by central differences
        turns = (model.tip_jacobian(q + step * dq)[:3] - model.tip_jacobian(q - step * dq)[:3]) @ dq / (2.0 * step)
        acceleration = model.tip_jacobian(q)[:3] @ ddq + turns
        np.testing.assert_allclose(acceleration, tip.tip.asked + tip.tip.mobility @ force, rtol=1e-5, atol=1e-5)


def test_the_posture_is_not_felt_by_the_tip(three_stages):
    """J M^-1 N^T tau_0 = 0, against what is left of tau_0 by the plain pseudo-inverse of J^T."""
    model = three_stages.model
    held, free = (pushing(three_stages, rate=rate) for rate in (30.0, 0.0))
    for q, dq, reference, _ in states(three_stages):
        posture = held.torque(0.0, q, dq, reference) - free.torque(0.0, q, dq, reference)
        J, M = model.tip_jacobian(q)[:3], model.mass_matrix(q)
        yields = np.linalg.solve(M, J.T)
        tau_0 = posture + J.T @ np.ones(3)
        moves = np.linalg.norm(yields.T @ tau_0)
        plain = tau_0 - J.T @ (np.linalg.pinv(J.T) @ tau_0)
        assert np.linalg.norm(yields.T @ posture) < 1e-10 * np.linalg.norm(posture) * np.linalg.norm(yields)
        assert np.linalg.norm(yields.T @ plain) > 1e-3 * moves


def test_a_riding_stage_sees_gravity_and_target_turned_and_moving(combined):
    """Its torques are those of the same arm on a fixed base, with R^T of the base's pose and motion."""
    tip = pushing(combined, "last_stage")
    mini, base = combined.stages[1], combined.model.with_tip(combined.stages[1].base_frame)
    alone, arm = WholeBody(mini.model, law(), mini.home, 0), PinocchioArm(mini.model)
    for q, dq, reference, _ in states(combined, 5):
        pose, motion = base.tip_pose(q), base.tip_jacobian(q) @ dq
        R, way = pose[:3, :3], reference[0] - pose[:3, 3]
        drift = R.T @ (reference[1] - motion[:3] - np.cross(motion[3:], way))
        target = np.array([R.T @ way, drift, np.zeros(3)])
        expected = alone.control(arm, alone.parameters, q[3:], dq[3:], target, R.T @ [0.0, 0.0, -9.81])
        np.testing.assert_allclose(tip.torque(0.0, q, dq, reference), expected, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(tip.tip.error, R.T @ way - mini.model.tip_position(q[3:]), atol=1e-12)
        true = R.T @ (combined.model.tip_jacobian(q)[:3] @ dq)
        np.testing.assert_allclose(tip.tip.velocity, true, atol=1e-10)
        np.testing.assert_allclose(tip.tip.lag, drift - mini.model.tip_jacobian(q[3:])[:3] @ dq[3:], atol=1e-10)


@pytest.mark.parametrize("stages", ["whole", "last_stage"])
def test_compiled_impedance_moves_as_the_interpreted_one(checked_config, stages):
    given = "controller=impedance", f"controller.actuated_stages={stages}", "environment=push", "duration=0.05"
    config = checked_config("robot=combined", "plant=rk4", "trajectory=quintic", *given)
    closed = assemble(config)
    assert closed.compiled is not None
    traces = [simulate(each, *make_sensors(each, config, 0)) for each in (closed, replace(closed, compiled=None))]
    np.testing.assert_allclose(traces[0].q, traces[1].q, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(traces[0].tau, traces[1].tau, rtol=0.0, atol=1e-7)
