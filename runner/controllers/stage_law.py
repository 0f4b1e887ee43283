"""The tip law of one stage, on its own dynamics."""

from runner.controllers.controller import FloatArray
from runner.controllers.joint_hold import JointHold
from runner.controllers.operational_space import tip_law
from runner.controllers.whole_body import WholeBodyLaw
from runner.robots.model import RobotModel


class StageLaw:
    """What a stage can be told to do from its own model alone: bring its tip somewhere, or hold a posture.

    The tip is brought there by tip_law: more joints than three are drawn home in its null space.

    Args:
        model: The stage's arm on a fixed base.
        natural_frequency: omega_n in rad/s.
        damping_ratio: xi.
        gravity_compensation: Whether the laws hold the gravity term.
        feedforward: Whether the tip law follows the reference's velocity and acceleration.
        singularity_damping: As in OperationalSpace.
        home: Joint positions at home, shape (nq,), in rad.

    Raises:
        ConfigError: if the arm has fewer than three joints.
    """

    def __init__(
        self,
        model: RobotModel,
        natural_frequency: float,
        damping_ratio: float,
        gravity_compensation: bool,
        feedforward: bool,
        singularity_damping: float,
        home: FloatArray,
    ) -> None:
        numbers = WholeBodyLaw(
            natural_frequency=natural_frequency,
            damping_ratio=damping_ratio,
            gravity_compensation=gravity_compensation,
            feedforward=feedforward,
            null_space_frequency=natural_frequency,
            max_tip_speed=None,
            singularity_damping=singularity_damping,
        )
        self._tip = tip_law(model, numbers, home)
        self._posture = JointHold(model, natural_frequency, damping_ratio, gravity_compensation)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector in the stage's base frame, shape (3,), in m/s^2."""
        self._tip.set_gravity(gravity)
        self._posture.set_gravity(gravity)

    def move(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques that bring the tip to a reference in the stage's base frame; see Controller.torque."""
        return self._tip.torque(time, q, dq, reference)

    def hold(self, q: FloatArray, dq: FloatArray, posture: FloatArray) -> FloatArray:
        """Return the torques that hold a posture, shapes (nq,)."""
        return self._posture.torque(q, dq, posture)
