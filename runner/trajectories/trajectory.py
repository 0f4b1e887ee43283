"""Trajectory protocol."""

from typing import Protocol

from runner.base.arrays import FloatArray


class Trajectory(Protocol):
    """Desired motion of the tip in the base frame."""

    @property
    def start(self) -> FloatArray:
        """Tip position at t = 0, shape (3,), in m."""

    @property
    def goal(self) -> FloatArray | None:
        """Tip position at the end of the motion, shape (3,), in m; None for a periodic motion."""

    @property
    def duration(self) -> float:
        """Time t_f after which the desired tip position is constant, in s; 0 for a goal, one period if periodic."""

    @property
    def run_duration(self) -> float:
        """Default duration of a run, in s."""

    @property
    def tracked(self) -> bool:
        """True if there is a motion to track; False for a goal only."""

    def sample(self, times: FloatArray) -> FloatArray:
        """Return desired position, velocity and acceleration, shape (T, 3, 3), in m, m/s and m/s^2."""

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance of each point to the geometric path, shapes (T, 3) to (T,), in m.

        Built-in trajectories take points of shape (..., 3) and return shape (...). The result of a point does not
        depend on the other points, not even by rounding.
        """

    def sample_joints(self, times: FloatArray) -> FloatArray | None:
        """Return the joint motion from which the motion of the tip follows, shape (T, 3, nq); None if there is none.

        Rows are q, dq/dt and d2q/dt2, in rad, rad/s, rad/s^2; m for prismatic joints.
        """


class OfTip:
    """Default of trajectories that are not derived from a joint motion."""

    def sample_joints(self, times: FloatArray) -> FloatArray | None:
        """Return None; see Trajectory."""
        return None


class _Timed(Protocol):
    @property
    def duration(self) -> float: ...
    @property
    def goal(self) -> FloatArray | None: ...


class TrackedMotion(OfTip):
    """Defaults of motions that are tracked; see Trajectory."""

    tracked = True

    @property
    def run_duration(self: _Timed) -> float:
        """One period; or one second more than a motion to rest, so that the settling of the arm is visible."""
        return self.duration if self.goal is None else self.duration + 1.0
