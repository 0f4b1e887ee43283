"""One joint under a held torque and no gravity, whose motion is known: q = tau t^2 / 2 I."""

from typing import NamedTuple

import numpy as np
import pytest
from support.friction import friction_law

from runner.assembly.compiled.commands import Commands, LoopCode
from runner.assembly.compiled.loop_program import LoopProgram, Setting, tangents
from runner.controllers.torque_law import TorqueLaw
from runner.plants.decoupled import ArmMotion, Motion
from runner.plants.motor_limits import TorqueLimits
from runner.robots.mismatch import scale_model
from runner.robots.model import RobotModel
from runner.sensing.encoders import EncoderNoise

URDF = """<robot name="wheel"><link name="base"/><link name="rod"><inertial><origin xyz="0.4 0 0"/><mass value="2"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.18"/></inertial></link><link name="tip"/>
<joint name="q1" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="100" velocity="100"/></joint><joint name="end" type="fixed"><parent link="rod"/>
<child link="tip"/><origin xyz="1 0 0"/></joint></robot>"""
TICK, TORQUE, INERTIA, LENGTH = 0.01, 3.0, 0.18 + 2.0 * 0.4**2, 1.0
TIMES = np.arange(41) * TICK


class HeldNumbers(NamedTuple):
    torque: float


class Held(TorqueLaw[HeldNumbers]):
    """Holds a torque."""

    def evaluate(self, arms, numbers, time, q, dq, reference, memory):
        return np.array([numbers.torque + 0.0 * q[0]], dtype=object), memory


@pytest.fixture
def wheel(one_stage):
    def make(torque=TORQUE, mass=1.0, length=1.0, limit=np.inf):
        model = scale_model(RobotModel(URDF, "tip", 0.0), np.array([mass]), np.ones(1), np.array([1.0, length]))
        robot, none = one_stage(URDF, model), np.zeros(1)
        loop = LoopCode(Held([model], False, HeldNumbers(torque)), slice(0, 1), 1, TICK)
        noise = EncoderNoise(none, none, none, "none", "exact")
        commands = Commands(robot, False, (loop,), noise, TorqueLimits.constant(np.array([limit])))
        motion = Motion(robot, (ArmMotion(URDF, model, slice(0, 1), friction_law()),), False)
        return LoopProgram(commands, motion, TICK, TICK, 1, 0)

    return make


def derivatives(loop_program, *others):
    """Return derivatives of the signals by parameters in which the numbers are linear: from others, 1 beyond."""
    errors, start = [np.zeros((len(TIMES), 1))], np.zeros(2)
    shared = loop_program.commands.shared(TIMES, np.zeros((len(TIMES), 3, 3)))
    finite = np.isfinite(loop_program.numbers)
    slopes = [
        Setting(
            np.subtract(other.numbers, loop_program.numbers, where=finite, out=np.zeros(len(finite))), start, errors
        )
        for other in others
    ]
    return tangents(loop_program, Setting(loop_program.numbers, start, errors), slopes, shared)


def test_angles_speeds_and_torques(wheel):
    found = derivatives(wheel(), wheel(torque=TORQUE + 1.0), wheel(mass=2.0), wheel(length=2.0))
    q, dq = TORQUE * TIMES**2 / (2.0 * INERTIA), TORQUE * TIMES / INERTIA
    for place, (by_q, by_dq, by_torque) in enumerate(
        [(q / TORQUE, dq / TORQUE, 1.0), (-q, -dq, 0.0), (0.0 * q, 0.0 * q, 0.0)]
    ):
        np.testing.assert_allclose(found.q[place, :, 0], by_q, rtol=1e-13, atol=1e-16)
        np.testing.assert_allclose(found.dq[place, :, 0], by_dq, rtol=1e-13, atol=1e-16)
        assert np.all(found.command[place] == by_torque)


def test_the_tip_moves_on_a_circle_as_long_as_the_link_though_that_is_1(wheel):
    found = derivatives(wheel(), wheel(torque=TORQUE + 1.0), wheel(length=2.0)).end_points[0]
    q = TORQUE * TIMES**2 / (2.0 * INERTIA)
    along, across = np.column_stack([np.cos(q), np.sin(q)]), np.column_stack([-np.sin(q), np.cos(q)])
    np.testing.assert_allclose(found[0, :, :2], LENGTH * across * q[:, None] / TORQUE, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(found[1, :, :2], along, rtol=1e-12, atol=1e-14)


def test_a_clipped_torque_changes_with_its_limit_alone(wheel):
    found = derivatives(wheel(limit=2.0), wheel(torque=TORQUE + 1.0, limit=2.0), wheel(limit=3.0))
    assert not found.command[0].any()
    assert not found.q[0].any()
    assert np.all(found.command[1] == 1.0)
    np.testing.assert_allclose(found.q[1, :, 0], TIMES**2 / (2.0 * INERTIA), rtol=1e-13, atol=1e-16)


def test_more_directions_than_lanes(wheel):
    found = derivatives(wheel(), *(wheel(torque=TORQUE + step) for step in range(1, 12)))
    np.testing.assert_allclose(found.q[10], 11.0 * found.q[0], rtol=1e-13)
