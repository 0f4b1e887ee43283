"""Inertial damping: tip motion of a mounted stage against the vibration of its base stage."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.macro_mini.stage_law import StageLaw, StageNumbers
from runner.controllers.macro_mini.stage_loops import StageLoop, base_at_home
from runner.controllers.torque_law import Arm
from runner.robots.robot import Robot
from runner.symbolic.maths import Array, Scalar


class DampingNumbers(NamedTuple):
    """The numbers of inertial damping.

    Attributes:
        law: Of the stage's law.
        offset: r_0, the tip's place at home in the stage's base frame, shape (3,), in m.
        gravity: In the robot's base frame, shape (3,), in m/s^2.
        share: g / (2 xi omega_c), of the base's velocity that is asked of the tip.
    """

    law: StageNumbers
    offset: Array
    gravity: Array
    share: Scalar


class InertialDamping(StageLoop[DampingNumbers]):
    r"""The loop of a riding stage that takes energy out of the vibration of its base, and gives tracking up.

    As others damped flexible arms by small ones at their ends (Lew and Trudnowski, IEEE Control Systems 16(1), 1996,
    the thesis' reference 14): the tip, seen from its base, is held to its home offset softly, and pushed along the
    base's velocity v_E, less the desired one.

    .. math:: F = g R^T (\dot x_E - \dot x_d) - 2 \xi \omega_c \dot p - \omega_c^2 (p - r_0), \qquad \tau = J^T
        \Lambda F + V + G

    Its law knows no acceleration of its base, so Lambda F is the force in the ground's frame, and its reaction brakes
    the base. A mode of frequency omega_1 and modal mass m_1 there, with the mass m of the tip along it, gains

    .. math:: \Delta \zeta_1 = \frac{m (g + 2 \omega_c)}{2 m_1 \omega_1}

    for omega_c well below omega_1, at a stroke of g X / omega_1 for an amplitude X.

    Args:
        robot: The robot.
        stage: Index of the stage, 1 or more.
        law: The stage's law, whose natural frequency is omega_c.
        gain: g, in 1/s.
    """

    def __init__(self, robot: Robot, stage: int, law: StageLaw, gain: float) -> None:
        self._law = law
        self._first, self._end = robot.stages[stage].joints.start, robot.stages[stage].joints.stop
        base, _ = base_at_home(robot, stage)
        numbers = DampingNumbers(
            law.numbers, robot.stages[stage].home_offset, robot.model.gravity, gain / law.numbers.k_v
        )
        super().__init__([law.model, base], law.gravity_compensation, numbers, robot.model.nq)

    def evaluate(
        self,
        arms: Sequence[Arm],
        numbers: DampingNumbers,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        memory: Array,
    ) -> tuple[Array, Array]:
        """Return the torques of this stage; see TorqueLaw."""
        own, base = arms
        _, R, moves = base.tip_pose_and_twist(q, dq)
        still: FloatArray = np.zeros(3)
        beside, gravity = np.array([numbers.share * (moves[:3] - reference[1]), numbers.gravity]).dot(R)
        target = np.array([numbers.offset, beside, still])
        own_q, own_dq = q[self._first : self._end], dq[self._first : self._end]
        return self._law.move(own, numbers.law, own_q, own_dq, target, gravity), memory
