"""Base classes of control laws, and the control loop."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol, Self, cast

from runner.base.arrays import FloatArray


class VelocityGain(NamedTuple):
    """K_v of a law at rest, tau = - K_v dq + ..., as a sum of two parts.

    Attributes:
        inertia: What multiplies diag M, in 1/s.
        mass: What multiplies M, in 1/s; of a law of the tip, of its fastest task.
        at_home: Whether diag M is that at home, or that at the posture.
    """

    inertia: float
    mass: float
    at_home: bool = True


class ControlLaw:
    """Defaults of what a control law may offer.

    Attributes:
        reads_joint_torques: True if it uses the joint torque sensors; see `read_joint_torques`.
    """

    reads_joint_torques = False

    @property
    def velocity_gain(self) -> VelocityGain | None:
        """K_v, for the stability limit of its sampled velocity loop; None if it is not known."""
        return None

    def with_limits(self, limits: FloatArray) -> Self:
        """Return the law that knows its torque limits, shape (n,), in N m; infinite where there is none."""
        return self

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Take the mean torques on the links since the last tick, of every joint, shape (nq,), in N m.

        The sensors are read at each tick of its loop, except the first.
        """


class Controller(ControlLaw):
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
        raise NotImplementedError


class PositionController(ControlLaw):
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
        raise NotImplementedError


class WrenchFeedbackController(Protocol):
    """A control law, of torques or of joint positions, that uses the external wrench on the tip.

    Attributes:
        external_wrench: Controller's estimate of the environment's wrench on the tip: force in N, moment about the tip
            in N m, along the base's axes, shape (6,).
    """

    external_wrench: FloatArray

    def update_wrench(self, reading: FloatArray) -> None:
        """Take the wrist sensor's reading, force in N and moment in N m along its own axes, shape (6,)."""

    def messages(self) -> list[str]:
        """Return messages for the user about the last run."""
        ...


@dataclass(frozen=True)
class Loop:
    """One control loop of a robot.

    Attributes:
        name: Name of the stage that it commands, or of what it does.
        joints: The joints that it commands, within the robot's.
        period: Time between two of its ticks, in s.
        controller: The control law; it is given the measurement of every joint.
        uses_wrench: True if its `update_wrench` also gets the wrist sensor's reading.
        follows_joints: Whether its reference is the desired motion of the joints, shape (3, nq), in place of the tip's.
    """

    name: str
    joints: slice
    period: float
    controller: Controller | PositionController
    uses_wrench: bool = False
    follows_joints: bool = False

    @property
    def wrench_feedback(self) -> WrenchFeedbackController | None:
        """The control law, if it uses the external wrench; else None."""
        return cast(WrenchFeedbackController, self.controller) if self.uses_wrench else None
