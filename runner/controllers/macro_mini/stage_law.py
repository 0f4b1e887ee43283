"""Control law of one stage from its own model: tip motion or a held configuration."""

from typing import Any, NamedTuple

from runner.base.arrays import FloatArray
from runner.controllers.operational_space.operational_space import tip_law
from runner.controllers.operational_space.whole_body import WholeBodyLaw
from runner.controllers.torque_law import Arm, structure_of
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class StageNumbers(NamedTuple):
    """The numbers of a stage's law.

    Attributes:
        tip: Of the law that leads its tip.
        k_p: omega_n^2 of a posture held, in 1/s^2.
        k_v: 2 xi omega_n of it, in 1/s.
    """

    tip: Any
    k_p: Scalar
    k_v: Scalar


class StageLaw:
    r"""What a stage can be told to do from its own model alone: bring its tip somewhere, or hold a posture.

    The tip is brought there by tip_law: more joints than three are drawn home in its null space. A posture q_0 is held
    by inverse dynamics in joint space:

    .. math:: \tau = M (-\omega_n^2 (q - q_0) - 2 \xi \omega_n \dot q) + V + G

    Args:
        model: The stage's arm on a fixed base.
        law: The numbers of both: omega_n and xi, whether they hold the gravity term, and those of the tip's law alone.
        home: Joint positions at home, shape (nq,), in rad.

    Attributes:
        model: The arm.
        gravity_compensation: As above.
        numbers: The numbers of both.

    Raises:
        ConfigError: if the arm has fewer than three joints.
    """

    def __init__(self, model: RobotModel, law: WholeBodyLaw, home: FloatArray) -> None:
        self.model, self.gravity_compensation = model, law.gravity_compensation
        self._tip: Any = tip_law(model, law, home)  # one of two, each with numbers of its own kind
        k_p, k_v = law.natural_frequency**2, 2.0 * law.damping_ratio * law.natural_frequency
        self.numbers = StageNumbers(self._tip.numbers, k_p, k_v)

    def structure(self) -> dict[str, Any]:
        """Return the attributes without the numbers; see TorqueLaw.structure."""
        return structure_of(self)

    def move(
        self, arm: Arm, numbers: StageNumbers, q: Array, dq: Array, reference: Array, gravity: Array | None = None
    ) -> Array:
        """Return the torques that bring the tip to a reference in the stage's base frame; see OperationalSpace.lead."""
        torque: Array = self._tip.lead(arm, numbers.tip, q, dq, reference, gravity)
        return torque

    def hold(
        self, arm: Arm, numbers: StageNumbers, q: Array, dq: Array, posture: Array, gravity: Array | None = None
    ) -> Array:
        """Return the torques that hold a posture, shape (nq,), in rad; see Arm.inverse_dynamics for gravity."""
        return arm.inverse_dynamics(q, dq, numbers.k_p * (posture - q) - numbers.k_v * dq, gravity)
