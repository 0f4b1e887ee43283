"""Base class of environments: wrench on the tip, forces on links and torques on joints."""

from collections.abc import Mapping, Sequence

from runner.base.arrays import FloatArray


class Environment:
    """The world around the arm. An environment must define `reset` and `wrench`; the rest has defaults.

    Attributes:
        points: Where it pushes links of the arm, in addition to the tip: by the name of a link, a point in the frame of
            that link, in m. It is read once, before the run.
    """

    points: Mapping[str, Sequence[float]] = {}

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
        raise NotImplementedError

    def link_forces(self, time: float, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the forces at `points`.

        Args:
            time: Time since the start, in s.
            positions: Positions of the points in the base frame, in their order, shape (n, 3), in m.
            velocities: Their velocities, shape (n, 3), in m/s.

        Returns:
            Forces in N along the base's axes, shape (n, 3).
        """
        raise NotImplementedError

    def joint_torques(self, time: float, q: FloatArray, dq: FloatArray) -> FloatArray | None:
        """Return torques on the joints, such as those of a cable or of a spring about an axis; None if there are none.

        Args:
            time: Time since the start, in s.
            q: True joint positions, shape (nq,), in rad; m if a joint is prismatic.
            dq: True joint velocities, shape (nq,), in rad/s; m/s if a joint is prismatic.

        Returns:
            Shape (nq,), in N m; N if a joint is prismatic.
        """
        return None
