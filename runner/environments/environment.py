"""Base class of environments: wrench on the tip, forces on links and torques on joints."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.base.arrays import FloatArray


class Environment:
    """Base class of environments. An environment must define `reset` and `wrench`; the other members have defaults.

    Attributes:
        points: Points of links on which the environment exerts forces, in addition to the tip: for the name of each
            link, a point in the link's frame, in m. The runner reads them once, before the run.
    """

    points: Mapping[str, Sequence[float]] = {}

    def begin(self, tick: float, generator: np.random.Generator) -> None:
        """Prepare for a repetition, before `reset`.

        Args:
            tick: Time between two updates, in s.
            generator: Generator of the random numbers of the environment, which follows from seed and repetition.
        """

    def reset(self, tip: FloatArray) -> None:
        """Reset the environment at the start of a run, with the tip position in the base frame, shape (3,), in m."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip.

        Args:
            time: Time since the start, in s.
            tip: Tip position in the base frame, shape (3,), in m.
            velocity: Linear velocity of the tip, shape (3,), in m/s.

        Returns:
            Force in N and moment about the tip in N m, along the axes of the base, shape (6,).
        """
        raise NotImplementedError

    def link_forces(self, time: float, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the forces at `points`.

        Args:
            time: Time since the start, in s.
            positions: Positions of the points in the base frame, in the order of `points`, shape (n, 3), in m.
            velocities: Velocities of the points, shape (n, 3), in m/s.

        Returns:
            Forces in N along the axes of the base, shape (n, 3).
        """
        raise NotImplementedError

    def joint_torques(self, time: float, q: FloatArray, dq: FloatArray) -> FloatArray | None:
        """Return torques on the joints, such as those of a cable or a torsion spring, or None.

        Args:
            time: Time since the start, in s.
            q: True joint positions, shape (nq,), in rad; m for prismatic joints.
            dq: True joint velocities, shape (nq,), in rad/s; m/s for prismatic joints.

        Returns:
            Shape (nq,), in N m; N for prismatic joints.
        """
        return None
