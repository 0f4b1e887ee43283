"""Computed-torque control of the joints."""

from typing import Literal, NamedTuple

from pydantic import NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import DesiredJoints, JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.torque_law import Arm, second_order
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class ComputedTorqueConfig(JointLawConfig):
    """Config of computed-torque control.

    Attributes:
        kind: Registry name of the controller.
        integral_gain: Gain k_i of the integral of each joint's error, in 1/s^3; 0 for no integral.
    """

    kind: Literal["computed_torque"]
    integral_gain: NonNegativeFloat


class ComputedTorqueParameters(NamedTuple):
    """The parameters of computed-torque control."""

    k_p: Scalar  # omega_n^2, in 1/s^2
    k_v: Scalar  # 2 xi omega_n, in 1/s
    k_i: Scalar  # integral gain, in 1/s^3


class ComputedTorque(JointLaw[ComputedTorqueParameters, ComputedTorqueConfig]):
    r"""Inverse dynamics in joint space (Luh, Walker and Paul, IEEE Transactions on Automatic Control 25(3), 1980).

    .. math:: \tau = M (\ddot q_d + 2 \xi \omega_n (\dot q_d - \dot q) + \omega_n^2 (q_d - q) + k_i z) + V + G

    With an exact model each joint's error obeys eq. (3.36) of the thesis at any configuration and speed. The integral z
    of q_d - q, summed at each tick, removes the error that a wrong model or a constant load causes at rest. The closed
    loop is stable for k_i < 2 xi omega_n^3. The integral winds up while a torque is at its limit. JointMotion defines
    q_d.
    """

    def choose_parameters(
        self, model: RobotModel, config: ComputedTorqueConfig, inertia: FloatArray
    ) -> ComputedTorqueParameters:
        """Return the parameters of the law above; see JointLaw."""
        self._state_size = model.nq if config.integral_gain > 0.0 else 0
        gains = second_order(config.natural_frequency, config.damping_ratio)
        return ComputedTorqueParameters(*gains, config.integral_gain)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(0.0, self.parameters.own.k_v)

    def command(
        self, arm: Arm, parameters: ComputedTorqueParameters, q: Array, dq: Array, desired: DesiredJoints, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above, and the integral at the next tick; see JointLaw."""
        error = desired.q - q
        ddq = desired.ddq + parameters.k_v * (desired.dq - dq) + parameters.k_p * error
        if self._state_size:
            ddq, state = ddq + parameters.k_i * state, state + desired.period * error
        return arm.inverse_dynamics(q, dq, ddq), state


CONFIG = ComputedTorqueConfig
FOLLOWS_JOINTS = True
TAKES_DRAWN = True
build = joint_law_builder(ComputedTorque)
