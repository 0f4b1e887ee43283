"""Trajectory protocol."""

from typing import Protocol, runtime_checkable

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


class _HasDuration(Protocol):
    @property
    def duration(self) -> float: ...


class TrackedMotion:
    """Defaults of a motion of the tip that comes to rest; see Trajectory."""

    tracked = True

    @property
    def run_duration(self: _HasDuration) -> float:
        """One second more than the motion, so that the rest of the arm is visible."""
        return self.duration + 1.0


@runtime_checkable
class LeadsJoints(Protocol):
    """A trajectory of the tip that follows from a desired motion of the joints."""

    def sample_joints(self, times: FloatArray) -> FloatArray:
        """Return q, dq/dt and d2q/dt2, shape (T, 3, nq): rows in rad, rad/s, rad/s^2; m where a joint slides."""
        ...


def joint_reference(path: Trajectory, times: FloatArray) -> FloatArray | None:
    """Return the motion of the joints that a path follows from, shape (T, 3, nq); None where there is none."""
    return path.sample_joints(times) if isinstance(path, LeadsJoints) else None
