"""Joint configurations, desired joint motions and the resulting tip motion."""

import math
from dataclasses import dataclass
from functools import cached_property
from math import comb
from typing import Annotated, Any, Protocol

import numpy as np
from pydantic import BeforeValidator

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, StageBase
from runner.schema.values import expand
from runner.trajectories.geometry import distance_to_curve
from runner.trajectories.trajectory import TrackedMotion

_DEGREE = 5


class SampledCurve:
    """Curve that interpolates the positions and first two derivatives of samples.

    The curve between two samples is a Bezier curve (Farin, Curves and Surfaces for CAGD, 2002, chapter 5). The
    derivatives are Bezier curves of the differences of its control points.

    Args:
        times: Times of the samples, ascending, shape (N,), in s.
        samples: Position and two derivatives at each sample, shape (N, 3, k).
    """

    def __init__(self, times: FloatArray, samples: FloatArray) -> None:
        self._times, self._steps = times, np.diff(times)
        h = self._steps[:, None]
        before, after = samples[:-1], samples[1:]
        self._controls = np.stack(
            [
                before[:, 0],
                before[:, 0] + h * before[:, 1] / 5.0,
                before[:, 0] + 2.0 * h * before[:, 1] / 5.0 + h**2 * before[:, 2] / 20.0,
                after[:, 0] - 2.0 * h * after[:, 1] / 5.0 + h**2 * after[:, 2] / 20.0,
                after[:, 0] - h * after[:, 1] / 5.0,
                after[:, 0],
            ],
            axis=1,
        )

    def sample(self, times: FloatArray) -> FloatArray:
        """Return position and two derivatives at times from the first sample to the last, shapes (T,) to (T, 3, k)."""
        place = np.clip(np.searchsorted(self._times, times, side="right") - 1, 0, len(self._steps) - 1)
        step = self._steps[place][:, None]
        share = (times - self._times[place])[:, None] / step
        controls, scale, orders = self._controls[place], np.ones_like(step), []
        for degree in range(_DEGREE, _DEGREE - 3, -1):
            rising, falling = _powers(share, degree), _powers(1.0 - share, degree)
            weights = np.array([comb(degree, k) for k in range(degree + 1)]) * rising * falling[:, ::-1]
            orders.append(scale * (weights[:, :, None] * controls).sum(axis=1))
            controls, scale = np.diff(controls, axis=1), scale * degree / step
        return np.stack(orders, axis=1)


def _powers(base: FloatArray, degree: int) -> FloatArray:
    """Return the powers 0 to a degree of a column, as products, shapes (T, 1) to (T, degree + 1)."""
    return np.asarray(np.cumprod(np.hstack([np.ones_like(base), *[base] * degree]), axis=1), dtype=np.float64)


def _configuration(value: Any) -> float | list[float]:
    numbers = value if isinstance(value, list) else [value]
    if not all(isinstance(n, int | float) and not isinstance(n, bool) and math.isfinite(n) for n in numbers):
        raise ValueError("must be a number, or a list of numbers with one for each joint")
    return [float(n) for n in numbers] if isinstance(value, list) else float(value)


Configuration = Annotated[float | list[float], BeforeValidator(_configuration)]


def configuration_of(key: str, value: Configuration, robot: Robot) -> FloatArray:
    """Return a configuration, shape (nq,), in rad.

    Raises:
        ConfigError: if the length of a list differs from the number of joints; the message contains their names.
    """
    return np.array(expand(key, value, robot.model.joint_names))


def start_of(value: Configuration | None, robot: Robot) -> FloatArray:
    """Return the configuration at t = 0, shape (nq,), in rad; None is home. Raises as configuration_of does."""
    return robot.home if value is None else configuration_of("trajectory.start_configuration", value, robot)


class JointMotion(Protocol):
    """Desired motion of the joints of a robot, from rest to rest, in rad and s; m for prismatic joints."""

    @property
    def start(self) -> FloatArray:
        """Joint positions at t = 0, shape (nq,)."""

    @property
    def duration(self) -> float:
        """Time t_f after which the joints rest, in s."""

    def sample(self, times: FloatArray) -> FloatArray:
        """Return q, dq/dt and d2q/dt2, shape (T, 3, nq)."""

    @property
    def samples(self) -> int:
        """Number of equal time intervals, so short that the path of the tip bends only once in each of them."""


@dataclass(frozen=True)
class TipOfJoints(TrackedMotion):
    r"""Motion of the tip that follows from a motion of the joints; see Trajectory for the attributes.

    .. math:: x = f(q), \qquad \dot x = J \dot q, \qquad \ddot x = J \ddot q + \dot J \dot q

    Attributes:
        robot: The robot.
        joints: The motion of the joints.
        ignore_base_rotation: True if the bases of mounted stages keep their orientation at the home configuration.
    """

    robot: Robot
    joints: JointMotion
    ignore_base_rotation: bool

    @property
    def q_start(self) -> FloatArray:
        """Joint positions at t = 0, shape (nq,), in rad."""
        return self.joints.start

    @property
    def start(self) -> FloatArray:
        """Tip position at t = 0."""
        start: FloatArray = self.sample(np.zeros(1))[0, 0]
        return start

    @property
    def goal(self) -> FloatArray:
        """Tip position at the end of the joint motion."""
        goal: FloatArray = self.sample(np.array([self.duration]))[0, 0]
        return goal

    @property
    def duration(self) -> float:
        """Time t_f of the joint motion, in s."""
        return self.joints.duration

    def sample_joints(self, times: FloatArray) -> FloatArray:
        """Return the motion of the joints; see JointMotion."""
        return self.joints.sample(times)

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion of the tip; it rests after t_f."""
        joints = self.joints.sample(times)
        robot = self.robot
        if not self.ignore_base_rotation:
            return _tip_motion(robot.model, joints)
        motion = _tip_motion(robot.model.with_tip(str(robot.stages[1].base_frame)), joints)
        for index, stage in enumerate(robot.stages[1:], start=1):
            R = StageBase(robot, index, ignore_base_rotation=True).rotation
            motion += _tip_motion(stage.model, joints[:, :, stage.joints]) @ R.T
        return motion

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the path of the tip, interpolated by SampledCurve."""
        return distance_to_curve(points, self._curve.sample, self._samples)

    @cached_property
    def _samples(self) -> FloatArray:
        return np.linspace(0.0, self.duration, self.joints.samples + 1)

    @cached_property
    def _curve(self) -> SampledCurve:
        return SampledCurve(self._samples, self.sample(self._samples))


def _tip_motion(model: RobotModel, joints: FloatArray) -> FloatArray:
    """Return position, velocity and acceleration of the tip, shape (T, 3, 3), from those of the joints."""
    arm, data, tip = model.pin_model, model.pin_model.createData(), model.tip_frame
    motion = np.empty((len(joints), 3, 3))
    for row, (q, dq, ddq) in zip(motion, np.ascontiguousarray(joints), strict=True):
        pin.forwardKinematics(arm, data, q, dq, ddq)
        pin.updateFramePlacement(arm, data, tip)
        row[0] = data.oMf[tip].translation
        row[1] = pin.getFrameVelocity(arm, data, tip, pin.LOCAL_WORLD_ALIGNED).linear
        row[2] = pin.getFrameClassicalAcceleration(arm, data, tip, pin.LOCAL_WORLD_ALIGNED).linear
    return motion
