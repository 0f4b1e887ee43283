"""Control law of one stage from its own model: tip motion or a held configuration."""

from typing import Any, NamedTuple

from runner.base.arrays import FloatArray
from runner.controllers.operational_space.operational_space import tip_law
from runner.controllers.operational_space.whole_body import WholeBodyLaw
from runner.controllers.torque_law import Arm, second_order, structure_of
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class StageNumbers(NamedTuple):
    """The numbers of a stage's law."""

    tip: Any
    k_p: Scalar  # omega_n^2 of a held configuration, in 1/s^2
    k_v: Scalar  # 2 xi omega_n of a held configuration, in 1/s


class StageLaw:
    r"""Control law of a stage from only its own model: move the tip, or hold a configuration.

    tip_law moves the tip; its null space pulls more than three joints home. Inverse dynamics in joint space hold a
    configuration q_0:

    .. math:: \tau = M (-\omega_n^2 (q - q_0) - 2 \xi \omega_n \dot q) + V + G

    Args:
        model: The stage's arm on a fixed base.
        law: Config of the tip law; omega_n, xi and the gravity term also apply to a held configuration.
        home: Joint positions at home, shape (nq,), in rad.

    Attributes:
        model: The arm.
        gravity_compensation: True if the law includes the gravity term.
        numbers: Numbers of the law.

    Raises:
        ConfigError: if the arm has fewer joints than the tip has directions of motion.
    """

    def __init__(self, model: RobotModel, law: WholeBodyLaw, home: FloatArray) -> None:
        self.model, self.gravity_compensation = model, law.gravity_compensation
        self._tip: Any = tip_law(model, law, home)  # OperationalSpace or WholeBody, with different types of numbers
        gains = second_order(law.natural_frequency, law.damping_ratio)
        self.numbers = StageNumbers(self._tip.numbers, *gains)

    def structure(self) -> dict[str, Any]:
        """Return the attributes without the numbers; see TorqueLaw.structure."""
        return structure_of(self)

    def move(
        self, arm: Arm, numbers: StageNumbers, q: Array, dq: Array, reference: Array, gravity: Array | None = None
    ) -> Array:
        """Return the torques that move the tip to a reference in the base frame of the stage; see WholeBody.control."""
        torque: Array = self._tip.control(arm, numbers.tip, q, dq, reference, gravity)
        return torque

    def hold(
        self, arm: Arm, numbers: StageNumbers, q: Array, dq: Array, posture: Array, gravity: Array | None = None
    ) -> Array:
        """Return the torques that hold a configuration, shape (nq,), in rad; see Arm.inverse_dynamics for gravity."""
        return arm.inverse_dynamics(q, dq, numbers.k_p * (posture - q) - numbers.k_v * dq, gravity)
