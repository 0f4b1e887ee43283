"""Inertial damping: tip motion of a mounted stage against the vibration of its base stage."""

from typing import NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.macro_mini.stage_loops import StageLaw, StageLoop, StageParameters, base_at_home
from runner.controllers.torque_law import Arms
from runner.robots.robot import Robot
from runner.symbolic.maths import Array, Scalar


class DampingParameters(NamedTuple):
    """The parameters of inertial damping."""

    law: StageParameters
    offset: Array  # r_0, position of the tip at home in the stage's base frame, shape (3,), in m
    gravity: Array  # gravity in the robot's base frame, shape (3,), in m/s^2
    share: Scalar  # g / (2 xi omega_c), the commanded tip velocity per base velocity


class InertialDamping(StageLoop[DampingParameters]):
    r"""The loop of a mounted stage that damps the vibration of its base instead of tracking.

    After the damping of flexible arms by small arms at their ends (Lew and Trudnowski, IEEE Control Systems 16(1),
    1996, reference 14 of the thesis). A soft spring holds the tip at its home offset p = r_0 in the base frame. A force
    pushes it along the base velocity less the desired velocity.

    .. math:: F = g R^T (\dot x_E - \dot x_d) - 2 \xi \omega_c \dot p - \omega_c^2 (p - r_0), \qquad \tau = J^T
        \Lambda F + V + G

    The law does not include the base acceleration, so Lambda F is the force in the ground frame. Its reaction damps the
    base. A mode of frequency omega_1 and modal mass m_1 at the base, with the tip mass m along it, gains the damping
    ratio

    .. math:: \Delta \zeta_1 = \frac{m (g + 2 \omega_c)}{2 m_1 \omega_1}

    for omega_c well below omega_1. The stroke is g X / omega_1 for an amplitude X.

    Args:
        robot: The robot.
        stage: Index of the stage, 1 or more.
        law: Law of the stage, with natural frequency omega_c.
        gain: g, in 1/s.
    """

    def __init__(self, robot: Robot, stage: int, law: StageLaw, gain: float) -> None:
        base, _ = base_at_home(robot, stage)
        parameters = DampingParameters(
            law.parameters, robot.stages[stage].home_offset, robot.model.gravity, gain / law.parameters.k_v
        )
        super().__init__(robot, stage, law, [base], parameters)

    def evaluate(
        self,
        arms: Arms,
        parameters: DampingParameters,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        state: Array,
    ) -> tuple[Array, Array]:
        """Return the torques of this stage; see TorqueLaw."""
        own, base = arms
        _, R, moves = base.tip_pose_and_twist(q, dq)
        still: FloatArray = np.zeros(3)
        beside, gravity = np.array([parameters.share * (moves[:3] - reference[1]), parameters.gravity]).dot(R)
        target = np.array([parameters.offset, beside, still])
        return self._law.move(own, parameters.law, *self.own(q, dq), target, gravity), state
