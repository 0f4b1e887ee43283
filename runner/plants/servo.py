"""Joint position servos of a torque-driven arm, with their set-points."""

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.base.portable import solve_symmetric
from runner.plants.motor_limits import TorqueLimits
from runner.plants.plant import Plant, PlantWrapper
from runner.robots.model import RobotModel
from runner.schema.model import StrictModel
from runner.schema.units import JointStiffness, Seconds
from runner.schema.values import PositivePerJoint, expand


class SetPoints:
    """Set-points of a position servo: commanded joint positions within the joints' speed limits.

    Args:
        ticks_per_command: Ticks from one command to the next.
        tick: Time between two set-points, in s.
        speed_limits: Largest joint speeds, shape (nq,), in rad/s; infinite without a limit.
        interpolate: True if a set-point moves at constant speed from one command to the next and reaches it a command's
            period late; False if it jumps as far as the speed limits allow.
        delay: Delay of a command, in ticks.
    """

    def __init__(
        self, ticks_per_command: int, tick: float, speed_limits: FloatArray, interpolate: bool, delay: int = 0
    ) -> None:
        self._ramp = ticks_per_command if interpolate else 1
        self._ticks_per_command = ticks_per_command
        self._tick = np.full(len(speed_limits), tick)  # an array is divided by faster than a float
        self._farthest = speed_limits * tick
        self._nearest = -self._farthest
        self._interpolate = interpolate
        self.position = np.zeros(len(speed_limits))
        """Set-point at the end of the tick, shape (nq,), in rad; updated in place."""
        self.velocity = np.zeros(len(speed_limits))
        """Velocity of the set-point within the tick, shape (nq,), in rad/s; zero without interpolation."""
        self._first = -delay % ticks_per_command
        self._count = self._first

    def reset(self, q: FloatArray) -> None:
        """Hold joint positions at rest."""
        self.position[:], self.velocity[:], self._count = q, 0.0, self._first

    def advance(self, command: FloatArray) -> None:
        """Move by one tick towards the command, joint positions of shape (nq,), in rad."""
        left = self._ramp - self._count % self._ramp  # ticks until the set-point reaches the command
        step = (command - self.position) / left
        np.minimum(np.maximum(step, self._nearest, out=step), self._farthest, out=step)
        self.position += step
        if self._interpolate:
            np.divide(step, self._tick, out=self.velocity)
        self._count = (self._count + 1) % self._ticks_per_command


class ServoConfig(StrictModel):
    """Config of the joints' position servos, which act if the controller commands joint positions.

    Attributes:
        stiffness: K, in N m/rad, or N/m for a prismatic joint. One value for all joints or a list with one for each.
        damping_ratio: xi of each joint with the others held at home; its damping is D = 2 xi sqrt(K M_ii).
        period: Time between two torques of the servo, in s.
        gravity_compensation: Whether the servo adds the torques that hold the arm and its payload.
        interpolate: Whether set-points move at constant speed between commands, or jump.
    """

    stiffness: JointStiffness[PositivePerJoint]
    damping_ratio: NonNegativeFloat
    period: Seconds[PositiveFloat]
    gravity_compensation: bool
    interpolate: bool


class ServoLaw:
    r"""Proportional-derivative control of every joint.

    Spring and damper are evaluated at the end of the servo's period h, with the resulting acceleration. So no stiffness
    or damping makes the sampled servo unstable (Tan, Liu and Turk do so for the damper, Stable proportional-derivative
    controllers, IEEE Computer Graphics and Applications 31(4), 2011):

    .. math::

        \tau = K (q_c - q - h \dot q - h^2 \ddot q) + D (\dot q_c - \dot q - h \ddot q) + G, \qquad
        (M + h D + h^2 K) \ddot q = K (q_c - q - h \dot q) + D (\dot q_c - \dot q) - V

    q_c and its velocity are those of the set-point at the end of the period. The first equation contains G only with
    gravity compensation. Without it, the second equation contains -G.

    Args:
        model: The servo's nominal model, for M, V and G.
        config: Config of the servo.
        home: Configuration at which the damping is set, shape (nq,), in rad.

    Raises:
        ConfigError: if the stiffness is a list of another length than the arm has joints.
    """

    def __init__(self, model: RobotModel, config: ServoConfig, home: FloatArray) -> None:
        self._model, self._data = model.separate()
        self._period = np.full(model.nq, config.period)  # an array is multiplied faster than a float
        self._stiffness = np.array(expand("plant.servo.stiffness", config.stiffness, model.joint_names))
        inertia = np.diagonal(model.mass_matrix(home))
        self._damping = 2.0 * config.damping_ratio * np.sqrt(self._stiffness * inertia)
        self._added_inertia = config.period * self._damping + config.period**2 * self._stiffness
        self._gravity_compensation = config.gravity_compensation

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._model.gravity.linear = gravity

    def torques(self, q: FloatArray, dq: FloatArray, position: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the servo torques without limits.

        Args:
            q: Joint positions, shape (nq,), in rad.
            dq: Joint velocities, shape (nq,), in rad/s.
            position: Set-point at the end of the period, shape (nq,), in rad.
            velocity: Velocity of the set-point, shape (nq,), in rad/s.

        Returns:
            Torques, shape (nq,), in N m.
        """
        model, data, h = self._model, self._data, self._period
        asked = self._stiffness * (position - q - h * dq) + self._damping * (velocity - dq)
        if self._gravity_compensation:
            asked += pin.computeGeneralizedGravity(model, data, q)
        M = pin.crba(model, data, q)  # fills the upper triangle only
        M.ravel("K")[:: len(q) + 1] += self._added_inertia  # the diagonal
        ddq = solve_symmetric(M.T, asked - pin.nonLinearEffects(model, data, q, dq))
        tau: FloatArray = asked - self._added_inertia * ddq
        return tau


class JointServo(PlantWrapper):
    """Position servos, by ServoLaw, around a torque plant; their torques are clipped at the effort limits.

    Args:
        plant: The plant; one call of `advance` takes one servo period.
        model: The servo's nominal model, for M, V and G.
        config: Config of the servo.
        home: Configuration at which the damping is set, shape (nq,), in rad.
        limits: Torque limits of all joints.
        ticks_per_command: Servo periods from one command to the next.
        delay: Delay of a command, in servo periods.

    Raises:
        ConfigError: if the stiffness is a list of another length than the arm has joints.
    """

    def __init__(
        self,
        plant: Plant,
        model: RobotModel,
        config: ServoConfig,
        home: FloatArray,
        limits: TorqueLimits,
        ticks_per_command: int,
        delay: int = 0,
    ) -> None:
        super().__init__(plant)
        self.tau = np.zeros(model.nq)
        self.load: FloatArray = np.zeros(model.nq)
        self._law = ServoLaw(model, config, home)
        self._limits = limits
        self._set_points = SetPoints(ticks_per_command, config.period, model.velocity_limits, config.interpolate, delay)

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state, and the set-points to its joint positions; see Plant."""
        super().reset(q, dq)
        self._set_points.reset(q)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        super().set_gravity(gravity)
        self._law.set_gravity(gravity)

    def advance(self, command: FloatArray) -> None:
        """Pull the joints towards their commanded positions for one servo period; see PositionPlant."""
        self._set_points.advance(command)
        tau = self._law.torques(self.q, self.dq, self._set_points.position, self._set_points.velocity)
        lowest, highest = self._limits.bounds(self.dq)
        np.minimum(np.maximum(tau, lowest, out=tau), highest, out=self.tau)
        self.plant.advance(self.tau + self.load)
