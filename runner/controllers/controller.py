"""What every controller offers."""

from dataclasses import dataclass
from typing import Protocol, cast

from runner.base.arrays import FloatArray


class Controller(Protocol):
    """A control law, pure in (time, measurement, reference) apart from what `reset` clears."""

    def reset(self) -> None:
        """Forget everything of an earlier run."""

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the joint torques.

        Args:
            time: Time since the start, in s.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s; of every joint, those of other stages included.
            reference: Desired tip position, velocity and acceleration in the base frame, shape (3, 3): a row each,
                in m, m/s, m/s^2. Of a loop that follows joints: desired joint positions, velocities and accelerations,
                shape (3, nq), in rad, rad/s, rad/s^2.

        Returns:
            Torques of the joints it commands before any limit, in N m; valid until the next call.

        Raises:
            numpy.linalg.LinAlgError: where the law has no solution, such as at a singular posture.
        """
        ...


class PositionController(Protocol):
    """A control law that tells the joints where to go, pure in its arguments apart from what `reset` clears."""

    def reset(self, q: FloatArray) -> None:
        """Forget everything of an earlier run; the arm stands at joint positions, shape (nq,), in rad."""

    def joint_positions(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the joint positions to reach by the loop's next tick.

        Args:
            time: Time since the start, in s.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            reference: Desired tip position, velocity and acceleration in the base frame, shape (3, 3); see
                Controller.torque.

        Returns:
            Positions of the joints it commands, in rad; valid until the next call.

        Raises:
            numpy.linalg.LinAlgError: where the law has no solution.
        """
        ...


class FeelingController(Protocol):
    """A control law, of torques or of joint positions, that feels what its tip touches.

    Attributes:
        felt: Wrench of the world on the tip as it believes it: force in N, moment about the tip in N m, along the
            base's axes, shape (6,).
    """

    felt: FloatArray

    def feel(self, reading: FloatArray) -> None:
        """Take the wrist sensor's reading, force in N and moment in N m along its own axes, shape (6,)."""

    def notices(self) -> list[str]:
        """Return what a user should know of how the last run went, a text for each."""
        ...


@dataclass(frozen=True)
class Loop:
    """One control loop of a robot.

    Attributes:
        name: Name of the stage that it commands, or of what it does.
        joints: The joints that it commands, within the robot's.
        period: Time between two of its ticks, in s.
        controller: The control law; it is given the measurement of every joint.
        feels: Whether it is given the wrist sensor's reading too, by its `feel`.
        follows_joints: Whether its reference is the desired motion of the joints, shape (3, nq), in place of the tip's.
    """

    name: str
    joints: slice
    period: float
    controller: Controller | PositionController
    feels: bool = False
    follows_joints: bool = False

    @property
    def feeling(self) -> FeelingController | None:
        """The control law as one that feels; None where it does not."""
        return cast(FeelingController, self.controller) if self.feels else None
