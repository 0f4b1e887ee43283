"""Trajectory protocol."""

from typing import Protocol

from runner.base.arrays import FloatArray


class Trajectory(Protocol):
    """A desired motion of the tip in the base frame."""

    @property
    def start(self) -> FloatArray:
        """Tip position where the arm stands at t = 0, shape (3,), in m."""
        ...

    @property
    def goal(self) -> FloatArray | None:
        """Tip position where the motion comes to rest, shape (3,), in m; None for a periodic one."""
        ...

    @property
    def duration(self) -> float:
        """Time t_f after which the desired tip rests, in s: zero for a goal; one period if periodic."""
        ...

    @property
    def run_duration(self) -> float:
        """How long a run lasts that is not told otherwise, in s."""
        ...

    @property
    def tracked(self) -> bool:
        """Whether there is a motion to track: False for a bare goal."""
        ...

    def sample(self, times: FloatArray) -> FloatArray:
        """Return desired position, velocity and acceleration, shape (T, 3, 3): rows in m, m/s, m/s^2."""
        ...

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return each point's distance to the path taken as a curve, shapes (T, 3) to (T,), in m.

        Ours take points of any shape (..., 3) and give (...), each as if it were alone.
        """
        ...

    def sample_joints(self, times: FloatArray) -> FloatArray | None:
        """Return the joint motion from which the motion of the tip follows, shape (T, 3, nq); None if there is none.

        Rows are q, dq/dt and d2q/dt2, in rad, rad/s, rad/s^2; m if a joint is prismatic.
        """
        ...


class OfTip:
    """Default of a trajectory that is not derived from a joint motion."""

    def sample_joints(self, times: FloatArray) -> FloatArray | None:
        """Return None; see Trajectory."""
        return None


class _HasDuration(Protocol):
    @property
    def duration(self) -> float: ...


class TrackedMotion(OfTip):
    """Defaults of a motion of the tip that comes to rest; see Trajectory."""

    tracked = True

    @property
    def run_duration(self: _HasDuration) -> float:
        """One second more than the motion, so that the rest of the arm is visible."""
        return self.duration + 1.0
