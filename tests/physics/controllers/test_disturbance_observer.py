"""Momentum observer against its closed form, under every law and with wrong models; refusals."""

import re
from unittest.mock import patch

import numpy as np
import pytest
from support.arms import checked, last_of_each
from support.physics import assert_same_motion

from runner.assembly.assemble import assemble
from runner.assembly.compiled import commands
from runner.base.errors import ConfigError
from runner.plants.rk4 import Rk4
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders
from runner.store import open_run

OBSERVED = ("disturbance_observer=momentum", "disturbance_observer.bandwidth=60")


def assembled(*overrides):
    closed = assemble(checked(*last_of_each(*overrides)))
    closed.close()
    return closed


def found(law):
    """r of an observed law, shape (n,)."""
    n = len(law.parameters.filter.limits)
    return law.state[-law._filter.state_size :][:n]


@pytest.mark.parametrize("name", ["macro", "xarm7"])
def test_a_step_of_torque_is_found_by_the_gain_of_each_tick(name):
    """r_k = (1 - exp(-L h k)) d within 1 % of d, on an arm in motion."""
    h, L = 0.001, 60.0
    line = (f"robot={name}", "controller=computed_torque", f"controller.period={h}", "trajectory=joint_quintic")
    closed = assembled(*line, "controller.natural_frequency=20", *OBSERVED)
    law, arm, path = closed.loops[0].controller, closed.robot, closed.trajectory
    plant, times = Rk4(arm.model, h, 1), h * np.arange(600)
    desired = path.sample_joints(times)
    plant.reset(desired[0, 0], np.zeros(arm.model.nq))
    law.reset()
    begins, d = 400, 0.05 * np.maximum(np.abs(arm.model.gravity_torque(arm.home)), 1.0)
    for tick, reference in enumerate(desired):
        torque = law.torque(h * tick, plant.q, plant.dq, reference)
        expected = (1.0 - np.exp(-L * h * max(tick - begins, 0))) * d
        np.testing.assert_allclose(found(law), expected, rtol=0.0, atol=0.01 * d.min())
        plant.advance(torque + (d if tick >= begins else 0.0))


@pytest.mark.parametrize(("more", "limits", "late"), [
    (("torque_limits.max=[30,60,20]",), [30.0, 60.0, 20.0], 0),
    (("plant.computation.delay=3",), np.inf, 3),
])  # fmt: skip
def test_it_knows_the_torque_that_acts(more, limits, late):
    """Under an exact model nothing is found, while torques are at their limits, and where commands come late."""
    h = 0.001
    line = ("robot=macro", "controller=computed_torque", f"controller.period={h}", "trajectory=joint_quintic")
    closed = assembled(*line, "trajectory.duration=0.3", "controller.natural_frequency=20", *more, *OBSERVED)
    law, arm, torques, r = closed.loops[0].controller, closed.robot, [], []
    plant = Rk4(arm.model, h, 1)
    plant.reset(arm.home, np.zeros(3))
    law.reset()
    for tick, reference in enumerate(closed.trajectory.sample_joints(h * np.arange(600))):
        torques.append(np.clip(law.torque(h * tick, plant.q, plant.dq, reference), -np.array(limits), limits))
        r.append(found(law))
        plant.advance(torques[max(tick - late, 0)])
    assert (np.abs(torques).max(axis=0) == limits).all() == bool(np.isfinite(limits).all())
    assert np.abs(r).max() < 2e-3 * np.abs(torques).max()


def assemble_by_pinocchio(config):
    with patch.object(commands, "evaluator", dict):
        closed = assemble(config)
    assert closed.compiled is None
    return closed


@pytest.mark.parametrize(("mass", "bandwidth", "stable"), [
    (1.0, 5000.0, True), (2.5, 700.0, True), (2.5, 1200.0, False), (4.0, 300.0, True), (4.0, 500.0, False),
])  # fmt: skip
def test_an_arm_lighter_than_believed_bounds_its_bandwidth(simulated, mass, bandwidth, stable):
    """1 - mu (1 - exp(-L h)) > -1, at h = 2 ms and omega_n h = 0.02: L < 805 1/s at 2.5, and 347 1/s at 4."""
    trace = simulated("robot=macro", "controller=computed_torque", "controller.period=0.002", "plant=rk4",
                      "controller.natural_frequency=10", f"mismatch.mass={mass}", "trajectory=joint_quintic",
                      f"disturbance_observer.bandwidth={bandwidth}", "duration=1")  # fmt: skip
    assert (trace.failure is None and np.abs(np.diff(trace.tau[-100:], axis=0)).max() < 1.0) == stable


def test_it_takes_away_what_a_wrong_model_and_friction_leave(simulated):
    """On the motion of a prototype at least twenty times: see test_joint_laws."""
    line = ("robot=macro", "controller=joint_pd", "controller.period=0.002", "plant=rk4", "trajectory=joint_quintic",
            "mismatch.mass=0.8", "plant.friction.viscous=0.2", "plant.friction.coulomb=0.5", "duration=6")  # fmt: skip
    goal = checked(*line).path.sample_joints(np.array([6.0]))[0, 0]
    without, carried = (np.abs(goal - simulated(*line, *more).q[-1]).max() for more in ((), OBSERVED))
    assert carried < 1e-3 * without


LAWS = [
    ("robot=macro", "controller=operational_space"),
    ("robot=macro", "controller=joint_pid"),
    ("robot=xarm7", "controller=adaptive", "robot.armature=assumed"),
    ("robot=xarm7", "controller=operational_space", "torque_limits.max=40"),
    ("robot=meca500", "controller=whole_body", "robot.armature=assumed"),
    ("robot=combined", "controller=macro_mini", "disturbance_observer.bandwidth={macro: 30, mini: 100}"),
    ("robot=combined", "controller=whole_body", "disturbance_observer.bandwidth=40"),
]


@pytest.mark.parametrize("line", LAWS)
def test_every_law_carries_it_compiled_as_by_pinocchio(line):
    noisy = () if line[0] == "robot=meca500" else ("noise=thesis",)
    wrong = ("plant=rk4", "mismatch.mass=0.9", *noisy)
    config = checked(*last_of_each(*OBSERVED, *line, "trajectory=quintic", "duration=0.1", *wrong))
    by_pinocchio, compiled = assemble_by_pinocchio(config), assemble(config)
    assert compiled.compiled is not None
    traces = [simulate(closed, make_encoders(closed, config.noise, 0, 0)) for closed in (by_pinocchio, compiled)]
    assert_same_motion(*traces)
    plain = checked(*line[:2], "trajectory=quintic", "plant=rk4", "duration=0.1")
    assert type(plain.loops[0].controller) is type(compiled.loops[0].controller._law)


PLAIN = """
    from typing import Literal
    from pydantic import PositiveFloat
    from runner.controllers import Loop
    from runner.plugins.registry import StrictModel
    class CONFIG(StrictModel):
        kind: Literal["{name}"]
        period: PositiveFloat
    class Law:
        def __init__(self, robot):
            self.robot = robot
        def reset(self):
            pass
        def torque(self, time, q, dq, reference):
            return {torque}
    def build(config, robot):
        return (Loop("arm", slice(0, robot.model.nq), config.period, Law(robot)),)
"""


def test_a_law_from_outside_carries_it(own_part, cli):
    """A law that only holds gravity sinks under an unknown payload, at a speed that its damping sets."""
    module = PLAIN.replace("{torque}", "self.robot.model.gravity_torque(q) - 5.0 * dq").replace("{name}", "holding")
    own = own_part("controller", "holding", module, "kind: holding\nperiod: 0.001\n")
    line = ("--config-dir", own, "robot=macro", "controller=holding", "trajectory=goal", "duration=1",
            "robot.payload.mass=1", "mismatch.payload=-1", "plant=rk4")  # fmt: skip
    falls, held = (open_run(cli(*line, *more).folder).metrics["peak_joint_speed"].median for more in ((), OBSERVED))
    assert held < 0.1 * falls


REFUSED = {
    "robot=xarm7 controller=differential_inverse_kinematics": "commands joint positions",
    "robot=combined controller=macro_mini plant.dynamics=decoupled": "take plant.dynamics=coupled",
    "robot=combined controller=whole_body plant.dynamics=decoupled": "take plant.dynamics=coupled",
    "controller.period=0.002 plant.step=0.001 controller=macro_mini robot=combined "
    "controller.period={macro: 0.01, mini: 0.001} plant.computation.delay=3": "not a multiple",
    "robot=macro disturbance_observer.bandwidth={mini: 3}": "no such loop",
    "robot=macro disturbance_observer.bandwidth=-1": "above 0",
}


@pytest.mark.parametrize("line", REFUSED)
def test_what_cannot_carry_it_is_refused_with_what_to_take(line):
    overrides = re.findall(r"\S+=(?:\{.*?\}|\S+)", line)
    with pytest.raises(ConfigError) as caught:
        checked(*last_of_each("disturbance_observer.bandwidth=60", *overrides))
    assert any("disturbance_observer" in problem and REFUSED[line] in problem for problem in caught.value.problems)
