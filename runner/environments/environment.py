"""Environment protocols: wrench on the tip, forces on links and torques on joints."""

from collections.abc import Mapping, Sequence
from typing import Protocol, runtime_checkable

from runner.base.arrays import FloatArray


class Environment(Protocol):
    """The world around the tip, as the wrench that it puts on it."""

    def reset(self, tip: FloatArray) -> None:
        """Start with the tip at a position in the base frame, shape (3,), in m."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip.

        Args:
            time: Time since the start, in s.
            tip: Tip position in the base frame, shape (3,), in m.
            velocity: Its linear velocity, shape (3,), in m/s.

        Returns:
            Force in N and moment about the tip in N m, along the base's axes, shape (6,).
        """
        ...


@runtime_checkable
class PushesLinks(Protocol):
    """An environment that pushes links of the arm at points beside the tip."""

    @property
    def points(self) -> Mapping[str, Sequence[float]]:
        """Where it pushes: by the name of a link, a point in that link's frame, in m. Asked once, before the run."""
        ...

    def link_forces(self, time: float, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the forces at these points.

        Args:
            time: Time since the start, in s.
            positions: Places of the points in the base frame, in their order, shape (n, 3), in m.
            velocities: Their velocities, shape (n, 3), in m/s.

        Returns:
            Forces in N along the base's axes, shape (n, 3).
        """
        ...


@runtime_checkable
class LoadsJoints(Protocol):
    """An environment that loads the joints themselves, as a cable or a spring about a joint's axis does."""

    def joint_torques(self, time: float, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the torques that it adds to those of the drives.

        Args:
            time: Time since the start, in s.
            q: True joint positions, shape (nq,), in rad; m where a joint slides.
            dq: True joint velocities, shape (nq,), in rad/s; m/s where a joint slides.

        Returns:
            Shape (nq,), in N m; N where a joint slides.
        """
        ...
