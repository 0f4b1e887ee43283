"""Control loops of riding arms: each stage's own law, and the target that the coupling gives it."""

from typing import Literal

import numpy as np

from runner.controllers.controller import FloatArray
from runner.controllers.stage_law import StageLaw
from runner.robots.robot import Robot, StageBase, end_points

Aim = Literal["rest", "own_offset", "base_offset"]


class Turns:
    """Whose turn it is, where only one arm moves at a time: a period of the carrier each, beginning with the carrier.

    Args:
        period: Length of a turn, in s.
    """

    def __init__(self, period: float) -> None:
        self._period = period

    def rider_moves(self, time: float) -> bool:
        """Tell whether it is the rider's turn."""
        return int(time / self._period + 1e-9) % 2 == 1


class _Posture:
    """A posture that is kept from the first moment of a hold to its end."""

    def __init__(self) -> None:
        self._held: FloatArray | None = None

    def keep(self, q: FloatArray) -> FloatArray:
        """Return the posture held, which is the present one when the hold begins."""
        if self._held is None:
            self._held = q.copy()
        return self._held

    def release(self) -> None:
        self._held = None


class CarrierController:
    """The loop of the first stage, which stands on the ground.

    Its target is x_d - o, where o stands for the stages that ride on it: nothing (macro_target tip_goal), their
    offset at home (minus_home), or their present offset (two-way coupling).

    Args:
        robot: The robot.
        law: The stage's law.
        offset: Offset o, shape (3,), in m; None takes the riders' present one.
        parallel: Whether the riders' base is taken parallel to the ground's.
        reach: Distance up to which the first rider follows its target, in m.
        turns: Whose turn it is; None where both arms move at any time.
    """

    def __init__(
        self, robot: Robot, law: StageLaw, offset: FloatArray | None, parallel: bool, reach: float, turns: Turns | None
    ) -> None:
        self._law, self._offset, self._reach, self._turns = law, offset, reach, turns
        self._joints = robot.stages[0].joints
        self._riders = robot.stages[1:]
        self._bases = [StageBase(robot, index, parallel) for index in range(1, len(robot.stages))]
        at_home = end_points(robot, robot.home[None])[:, 0]
        self._later = at_home[-1] - at_home[1]  # of the stages that ride on the first rider
        self._posture = _Posture()

    def reset(self) -> None:
        """Forget the posture held."""
        self._posture.release()

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of the first stage; see Controller.torque."""
        own_q, own_dq = q[self._joints], dq[self._joints]
        if self._turns is not None and self._turns.rider_moves(time):
            self._bases[0].update(q, dq)
            distance = reference[0] - self._bases[0].position - self._later
            if distance.dot(distance) <= self._reach**2:
                return self._law.hold(own_q, own_dq, self._posture.keep(own_q))
        self._posture.release()
        target = reference.copy()
        target[0] -= self._present_offset(q, dq) if self._offset is None else self._offset
        return self._law.move(time, own_q, own_dq, target)

    def _present_offset(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        offset = np.zeros(3)
        for rider, base in zip(self._riders, self._bases, strict=True):
            base.update(q, dq)
            offset += base.rotation.dot(rider.model.tip_position(q[rider.joints]))
        return offset


class RiderController:
    """The loop of a stage that rides on others.

    Its target is the rest of the way, R^T (x_d - o - x_E), seen from its base. As for the first stage, o is the home
    offset of the stages that ride on it, whatever way they have turned; each of them makes up for what is left. Reach
    counts from its base to this target, so that it is that of the stage's own arm. Gravity seen from its base is R^T g.

    Or it follows nothing and keeps its own home offset: r_0 in its own frame, which turns with the carrier, or R^T r_0
    with r_0 in the robot's base frame.

    Args:
        robot: The robot.
        stage: Index of the stage, 1 or more.
        law: The stage's law.
        aim: What its target is: the rest of the way, or its home offset in its own frame or in the robot's base frame.
        later_offset: Home offset o of the stages that ride on this one, in the robot's base frame, shape (3,), in m.
        parallel: Whether its base is taken parallel to the ground's.
        moving_target: Whether the target's velocity is part of the reference.
        reach: Distance up to which it follows, in m.
        stretch: Whether it stretches towards a target beyond reach; else it holds its posture.
        turns: Whose turn it is; None where both arms move at any time.
    """

    def __init__(
        self,
        robot: Robot,
        stage: int,
        law: StageLaw,
        aim: Aim,
        later_offset: FloatArray,
        parallel: bool,
        moving_target: bool,
        reach: float,
        stretch: bool,
        turns: Turns | None,
    ) -> None:
        self._law, self._aim, self._later, self._moving = law, aim, later_offset, moving_target
        self._reach, self._stretch, self._turns = reach, stretch, turns
        self._joints = robot.stages[stage].joints
        self._home_offset = robot.stages[stage].home_offset
        self._base = StageBase(robot, stage, parallel)
        self._base.update(robot.home, np.zeros_like(robot.home))
        self._base_offset = self._base.rotation.dot(self._home_offset)
        self._gravity = robot.model.gravity
        self._posture = _Posture()

    def reset(self) -> None:
        """Forget the posture held."""
        self._posture.release()

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of this stage; see Controller.torque."""
        base = self._base
        base.update(q, dq)
        R = base.rotation
        self._law.set_gravity(R.T.dot(self._gravity))
        own_q, own_dq = q[self._joints], dq[self._joints]
        rest = reference[0] - self._later - base.position
        distance_squared = rest.dot(rest)
        waits = self._turns is not None and not self._turns.rider_moves(time)
        beyond = distance_squared > self._reach**2 and not self._stretch
        if self._aim == "rest" and (waits or beyond):
            return self._law.hold(own_q, own_dq, self._posture.keep(own_q))
        self._posture.release()
        target = np.zeros((3, 3))
        if self._aim == "rest":
            target[0] = R.T.dot(rest)
            if distance_squared > self._reach**2:
                target[0] *= self._reach / np.sqrt(distance_squared)
            elif self._moving:
                velocity, spin = base.velocity()
                target[1] = R.T.dot(reference[1] - velocity - _cross(spin, rest))
        elif self._aim == "base_offset":
            target[0] = R.T.dot(self._base_offset)
            if self._moving:
                target[1] = R.T.dot(-_cross(base.velocity()[1], self._base_offset))
        else:
            target[0] = self._home_offset
        return self._law.move(time, own_q, own_dq, target)


class HeldController:
    """The loop of a riding stage whose joints are held at home.

    Args:
        robot: The robot.
        stage: Index of the stage, 1 or more.
        law: The stage's law.
        parallel: Whether its base is taken parallel to the ground's.
    """

    def __init__(self, robot: Robot, stage: int, law: StageLaw, parallel: bool) -> None:
        self._law = law
        self._joints, self._home = robot.stages[stage].joints, robot.stages[stage].home
        self._base = StageBase(robot, stage, parallel)
        self._gravity = robot.model.gravity

    def reset(self) -> None:
        """Do nothing: the law has no memory."""

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of this stage; see Controller.torque."""
        self._base.update(q, dq)
        self._law.set_gravity(self._base.rotation.T.dot(self._gravity))
        return self._law.hold(q[self._joints], dq[self._joints], self._home)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return a x b; numpy's own takes ten times as long for single vectors."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))
