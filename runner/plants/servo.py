"""Joint position servos of a torque-driven arm, with their set-points."""

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import lapack, pin
from runner.plants.plant import Plant, PlantWrapper
from runner.robots.model import RobotModel
from runner.schema.model import StrictModel
from runner.schema.units import JointStiffness, Seconds
from runner.schema.values import PositivePerJoint, expand


class SetPoints:
    """What a position servo follows: commanded joint positions, no faster than the joints may move.

    Args:
        ticks_per_command: Ticks from one command to the next.
        tick: Time between two set-points, in s.
        speed_limits: Largest joint speeds, shape (nq,), in rad/s; infinite where there is none.
        interpolate: Whether a set-point moves evenly from one command to the next, a command's period late, or jumps
            as far as the speed limits allow.
        delay: Ticks that a command is late.
    """

    def __init__(
        self, ticks_per_command: int, tick: float, speed_limits: FloatArray, interpolate: bool, delay: int = 0
    ) -> None:
        self._ramp = ticks_per_command if interpolate else 1
        self._ticks_per_command = ticks_per_command
        self._tick = tick
        self._farthest = speed_limits * tick
        self._interpolate = interpolate
        self.position = np.zeros(len(speed_limits))
        """Set-point at the end of the tick, shape (nq,), in rad; renewed in place."""
        self.velocity = np.zeros(len(speed_limits))
        """Its velocity within the tick, shape (nq,), in rad/s; zero where it jumps."""
        self._first = -delay % ticks_per_command
        self._count = self._first

    def reset(self, q: FloatArray) -> None:
        """Stand still at joint positions."""
        self.position[:], self.velocity[:], self._count = q, 0.0, self._first

    def advance(self, command: FloatArray) -> None:
        """Move on by one tick towards the command, joint positions of shape (nq,), in rad."""
        left = self._ramp - self._count % self._ramp  # ticks until the command is to be reached
        step = (command - self.position) / left
        np.clip(step, -self._farthest, self._farthest, out=step)
        self.position += step
        if self._interpolate:
            self.velocity[:] = step / self._tick
        self._count = (self._count + 1) % self._ticks_per_command


class ServoConfig(StrictModel):
    """Config of the joints' position servos, which act where the controller commands joint positions.

    Attributes:
        stiffness: K, in N m/rad; N/m where a joint slides. Of every joint or one for each.
        damping_ratio: xi of each joint on its own, the others held at home; its damping is D = 2 xi sqrt(K M_ii).
        period: Time between two torques of the servo, in s.
        gravity_compensation: Whether the servo adds the torques that hold the arm and its payload.
        interpolate: Whether set-points move evenly between commands, or jump.
    """

    stiffness: JointStiffness[PositivePerJoint]
    damping_ratio: NonNegativeFloat
    period: Seconds[PositiveFloat]
    gravity_compensation: bool
    interpolate: bool


class ServoLaw:
    r"""Proportional-derivative control of every joint.

    The spring and the damper are evaluated at the end of the servo's period h, with the acceleration that follows from
    them, so that no stiffness or damping makes the sampled servo unstable (as Tan, Liu and Turk do for the damper,
    Stable proportional-derivative controllers, IEEE Computer Graphics and Applications 31(4), 2011):

    .. math::

        \tau = K (q_c - q - h \dot q - h^2 \ddot q) + D (\dot q_c - \dot q - h \ddot q) + G, \qquad
        (M + h D + h^2 K) \ddot q = K (q_c - q - h \dot q) + D (\dot q_c - \dot q) - V

    q_c and its velocity are the set-point's at the end of the period; G is there with gravity compensation, and in the
    second equation -G without.

    Args:
        model: The servo's nominal arm, for M, V and G.
        config: The servo's numbers.
        home: Posture at which the damping is set, shape (nq,), in rad.

    Raises:
        ConfigError: if the stiffness is a list of another length than the arm has joints.
    """

    def __init__(self, model: RobotModel, config: ServoConfig, home: FloatArray) -> None:
        self._model = pin.Model(model.pin_model)
        self._data = self._model.createData()
        self._period = config.period
        self._stiffness = np.array(expand("plant.servo.stiffness", config.stiffness, model.joint_names))
        inertia = np.diagonal(model.mass_matrix(home))
        self._damping = 2.0 * config.damping_ratio * np.sqrt(self._stiffness * inertia)
        self._added_inertia = config.period * self._damping + config.period**2 * self._stiffness
        self._gravity_compensation = config.gravity_compensation

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector; see Plant."""
        self._model.gravity.linear = gravity

    def torques(self, q: FloatArray, dq: FloatArray, position: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return what the law asks for, no limit applied.

        Args:
            q: Joint positions, shape (nq,), in rad.
            dq: Joint velocities, shape (nq,), in rad/s.
            position: Set-point at the end of the period, shape (nq,), in rad.
            velocity: Its velocity, shape (nq,), in rad/s.

        Returns:
            Shape (nq,), in N m.
        """
        model, data, h = self._model, self._data, self._period
        bias = pin.nonLinearEffects(model, data, q, dq).copy()
        M = pin.crba(model, data, q)  # its upper triangle is all that dposv reads
        G = pin.computeGeneralizedGravity(model, data, q) if self._gravity_compensation else 0.0
        spring = self._stiffness * (position - q - h * dq)
        slip = velocity - dq
        np.einsum("ii->i", M)[:] += self._added_inertia
        asked = spring + self._damping * slip + G
        _, ddq, _ = lapack.dposv(M, asked - bias)
        tau: FloatArray = asked - self._added_inertia * ddq
        return tau


class JointServo(PlantWrapper):
    """Position servos, by ServoLaw, around a plant that takes torques; these are clipped at the effort limits.

    Args:
        plant: The plant; one `advance` of it takes a servo period.
        model: The servo's nominal arm, for M, V and G.
        config: The servo's numbers.
        home: Posture at which the damping is set, shape (nq,), in rad.
        limits: Torque limits, shape (nq,), in N m; infinite where there is none.
        ticks_per_command: Servo periods from one command to the next.
        delay: Servo periods that a command is late.

    Raises:
        ConfigError: if the stiffness is a list of another length than the arm has joints.
    """

    def __init__(
        self,
        plant: Plant,
        model: RobotModel,
        config: ServoConfig,
        home: FloatArray,
        limits: FloatArray,
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
        """Put the arm into a state, its set-points where it stands; see Plant."""
        super().reset(q, dq)
        self._set_points.reset(q)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector; see Plant."""
        super().set_gravity(gravity)
        self._law.set_gravity(gravity)

    def advance(self, command: FloatArray) -> None:
        """Pull the joints towards their commanded positions for one servo period; see PositionPlant."""
        self._set_points.advance(command)
        tau = self._law.torques(self.q, self.dq, self._set_points.position, self._set_points.velocity)
        np.clip(tau, -self._limits, self._limits, out=self.tau)
        self.plant.advance(self.tau + self.load)
