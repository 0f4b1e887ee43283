"""Base classes of control laws, and the control loop."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol, Self, cast

from runner.base.arrays import FloatArray


class VelocityGain(NamedTuple):
    """K_v of a law at rest, tau = - K_v dq + ..., as K_v = inertia diag M + mass M.

    Attributes:
        inertia: Factor of diag M, in 1/s.
        mass: Factor of M, in 1/s; for a tip law, that of its fastest task.
        at_home: True if diag M is taken at home; False if at the current configuration.
    """

    inertia: float
    mass: float
    at_home: bool = True


class ControlLaw:
    """Defaults of the optional members of a control law.

    Attributes:
        reads_joint_torques: True if the law uses the joint torque sensors; see `read_joint_torques`.
    """

    reads_joint_torques = False

    @property
    def velocity_gain(self) -> VelocityGain | None:
        """K_v, for the stability limit of the sampled velocity loop; None if unknown."""
        return None

    def with_limits(self, limits: FloatArray) -> Self:
        """Return the law with its torque limits set, shape (n,), in N m; infinite if there is none."""
        return self

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Store the mean torque on each link since the last tick, shape (nq,), in N m.

        Called at each tick of the loop except the first.
        """


class Controller(ControlLaw):
    """A torque control law, a pure function of (time, measurement, reference) and the state that `reset` clears."""

    def reset(self) -> None:
        """Clear the state of an earlier run."""

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the joint torques.

        Args:
            time: Time since the start, in s.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities of all stages, shape (nq,), in rad/s.
            reference: Desired tip position, velocity and acceleration in the base frame, one in each row, shape (3, 3),
                in m, m/s, m/s^2. If the loop follows joints: desired joint positions, velocities and accelerations,
                shape (3, nq), in rad, rad/s, rad/s^2.

        Returns:
            Torques of the commanded joints before any limit, in N m; valid until the next call.

        Raises:
            numpy.linalg.LinAlgError: if the law has no solution, such as at a singular configuration.
        """
        raise NotImplementedError


class PositionController(ControlLaw):
    """A joint position control law, a pure function of its arguments and the state that `reset` clears."""

    def reset(self, q: FloatArray) -> None:
        """Clear the state of an earlier run and start at joint positions, shape (nq,), in rad."""

    def joint_positions(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the joint positions to reach by the next tick.

        Args:
            time: Time since the start, in s.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            reference: Desired tip position, velocity and acceleration in the base frame, shape (3, 3); see
                Controller.torque.

        Returns:
            Positions of the commanded joints, in rad; valid until the next call.

        Raises:
            numpy.linalg.LinAlgError: if the law has no solution.
        """
        raise NotImplementedError


class WrenchFeedbackController(Protocol):
    """A torque or position control law that uses the external wrench on the tip.

    Attributes:
        external_wrench: Estimated external wrench on the tip in the base frame, shape (6,): force in N, then moment
            about the tip in N m.
    """

    external_wrench: FloatArray

    def update_wrench(self, reading: FloatArray) -> None:
        """Store the wrist sensor's reading, shape (6,): force in N and moment in N m along the sensor axes."""

    def messages(self) -> list[str]:
        """Return messages for the user about the last run."""
        ...


@dataclass(frozen=True)
class Loop:
    """One control loop of a robot.

    Attributes:
        name: Name of the loop, usually that of its stage.
        joints: Commanded joints, as a slice of the robot's joints.
        period: Time between two ticks, in s.
        controller: Control law; its arguments hold the measurements of every joint.
        uses_wrench: True if the controller's `update_wrench` receives the wrist sensor's reading.
        follows_joints: True if the reference is the desired joint motion, shape (3, nq), instead of the tip motion.
    """

    name: str
    joints: slice
    period: float
    controller: Controller | PositionController
    uses_wrench: bool = False
    follows_joints: bool = False

    @property
    def wrench_feedback(self) -> WrenchFeedbackController | None:
        """The controller if it uses the external wrench; else None."""
        return cast(WrenchFeedbackController, self.controller) if self.uses_wrench else None
