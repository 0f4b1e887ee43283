"""Friction of joints, and of motors behind springs, over a tick."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.base.portable import solve_symmetric
from runner.plants.flexible_joints import FlexibleJoints
from runner.plants.friction_law import JointFriction
from runner.plants.plant import Plant, PlantWrapper
from runner.robots.model import RobotModel
from runner.symbolic.maths import NUMPY, Array, Backend, Scalar

MOST_PIVOTS = 100  # upper limit; an arm of ten joints needs one if no joint starts or stops, else a few
_ROUNDING = 1e-12  # relative to the acting torques


def with_friction(plant: Plant, model: RobotModel, law: JointFriction, tick: float) -> Plant:
    """Return a plant with friction in its joints or in the motors behind them; the plant itself without friction."""
    if not law.acts.any():
        return plant
    if isinstance(plant, FlexibleJoints):
        return MotorFriction(plant, law, tick)
    return Frictional(plant, model, law, tick)


class _Friction(PlantWrapper):
    """A plant whose motor torques are reduced by friction, which is held over a tick.

    Args:
        plant: The plant without friction; one call of `advance` takes one tick.
        law: Friction of each joint.
        tick: h, in s.
    """

    def __init__(self, plant: Plant, law: JointFriction, tick: float) -> None:
        super().__init__(plant)
        self._law, self._tick, self._asymmetry = law, tick, np.array(law.asymmetry)
        self._friction = np.zeros(len(plant.q))
        self._direction = np.zeros(len(plant.q))
        """0 for a joint that friction held in the last tick, 1 or -1 for one that moved up or down."""

    @property
    def friction(self) -> FloatArray:
        """Friction torques in the last tick; see Plant."""
        return self._friction

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state; see Plant."""
        super().reset(q, dq)
        self._direction = np.sign(dq)

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques minus friction for one tick; see Plant."""
        self._friction = self._find_friction(tau)
        self.plant.advance(tau - self._friction)

    @staticmethod
    def _law_of_tick(law: JointFriction, v: FloatArray, direction: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return a law for a tick, as arrays; see JointFriction.at."""
        damping, level = law.at(NUMPY, v.tolist(), (direction == 0.0).tolist())
        return np.array(damping), np.array(level)

    def _find_friction(self, tau: FloatArray) -> FloatArray:
        """Return the friction torques under motor torques, shapes (nq,), in N m."""
        raise NotImplementedError


class Frictional(_Friction):
    r"""A plant with friction in its joints, by backward Euler over the plant's tick h.

    .. math:: (M + h b) \dot q^+ = M \dot q + h (\tau - V - G - o - \mu), \quad
        \mu \in l \, \mathrm{sgn}(\dot q^+), \qquad \tau_f = -b \dot q^+ - o - \mu

    b, with the sigmoid's secant, and the level l are those of the law at the start of the tick, where l is the static
    level if friction held the joint in the last tick; o is the asymmetry. mu is the torque that stops a joint within
    the tick, or the whole l if that does not suffice. So even large friction causes no oscillation, and friction never
    adds energy. tau_f is held over the tick and is of first order in h. tau contains all loads on the joints. Contact
    forces that the plant computes enter with their values of the last tick.

    Args:
        plant: The plant without friction; one call of `advance` takes one tick.
        model: Model of the arm, for M, V and G.
        law: Friction of each joint.
        tick: h, in s.
    """

    def __init__(self, plant: Plant, model: RobotModel, law: JointFriction, tick: float) -> None:
        super().__init__(plant, law, tick)
        self._model, self._data = model.separate()
        self._dry = law.dry

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        super().set_gravity(gravity)
        self._model.gravity.linear = gravity

    def _find_friction(self, tau: FloatArray) -> FloatArray:
        model, data, h = self._model, self._data, self._tick
        bias = pin.nonLinearEffects(model, data, self.q, self.dq).copy()
        M = np.triu(pin.crba(model, data, self.q))  # crba fills the upper triangle only
        M += np.triu(M, 1).T
        damping, level = self._law_of_tick(self._law, self.dq, self._direction)
        pushed = M @ self.dq + h * (tau + self._contact_torque() - bias - self._asymmetry)
        columns = solve_symmetric(M + np.diag(h * damping), np.column_stack([pushed, h * np.eye(len(tau))]))
        speed, mobility = columns[:, 0], columns[:, 1:]
        mu = np.zeros(len(tau))
        if self._dry:
            mu, self._direction = stopping_torques(mobility, speed, level, self._direction)
        friction: FloatArray = damping * (speed - mobility @ mu) + mu + self._asymmetry
        return friction

    def _contact_torque(self) -> FloatArray:
        """Return the joint torques of the plant's contacts in the last tick, shape (nq,), in N m."""
        wrench = self.plant.contact_wrench()
        if wrench is None or not wrench.any():
            return np.zeros(len(self.q))
        pin.computeJointJacobians(self._model, self._data, self.q)
        torque: FloatArray = pin.getJointJacobian(self._model, self._data, self._model.nq, pin.WORLD).T @ wrench
        return torque


class MotorFriction(_Friction):
    r"""Flexible joints with motor friction, by backward Euler over the tick h; see Frictional.

    .. math:: (B + h b) \dot\theta^+ = B \dot\theta + h (\tau - K (\theta - q) - D (\dot\theta - \dot q) - o - \mu)

    The motors do not act on each other, so mu is the torque that stops a motor within the tick, clipped at its level.
    The springs' torques are held over the tick.

    Args:
        plant: The plant without friction.
        law: Friction of each joint's motor; 0 for a rigid joint.
        tick: h, in s.
    """

    def __init__(self, plant: FlexibleJoints, law: JointFriction, tick: float) -> None:
        super().__init__(plant, law, tick)
        self._springs = plant
        self._own = law.of(plant.flexibility.flexible)

    def _find_friction(self, tau: FloatArray) -> FloatArray:
        plant, h, on = self._springs, self._tick, self._springs.flexibility.flexible
        B, o = plant.flexibility.motors[on], self._asymmetry[on]
        b, level = self._law_of_tick(self._own, plant.dtheta[on], self._direction[on])
        free = (B * plant.dtheta[on] + h * ((tau - plant.spring_torque())[on] - o)) / (B + h * b)
        stopping = free * (B + h * b) / h
        mu = np.clip(stopping, -level, level)
        self._direction[on] = np.where(mu == stopping, 0.0, np.sign(free))
        friction = np.zeros(len(tau))
        friction[on] = b * (free - h * mu / (B + h * b)) + mu + o
        return friction


def stopping_torques(
    mobility: FloatArray, speed: FloatArray, limit: FloatArray, direction: FloatArray
) -> tuple[FloatArray, FloatArray]:
    r"""Return the dry friction that stops every joint, or its limit if that does not suffice.

    .. math:: v = v_0 - A \mu, \qquad |\mu_i| \le c_i, \qquad
        v_i = 0 \;\text{ or }\; \mu_i = c_i \, \mathrm{sgn} \, v_i

    has one solution, because A is positive definite. Pivoting finds it: the first joint on the wrong side changes
    sides. The search ends after a finite number of pivots (Murty, Opsearch 11, 1974; for bounds on both sides Judice
    and Pires, Computers and Operations Research 21(5), 1994).

    Args:
        mobility: A, change of speeds by torques, shape (nq, nq), in rad/s per N m.
        speed: v_0 without dry friction, shape (nq,), in rad/s.
        limit: c, shape (nq,), in N m.
        direction: First guess, shape (nq,): 0 for a joint that stops, 1 or -1 for one that keeps moving up or down.

    Returns:
        mu, shape (nq,), in N m; and the direction of each joint, as above.
    """
    for _ in range(MOST_PIVOTS):
        mu, direction, agrees = pivot(NUMPY, mobility, speed, limit, direction)
        if agrees:
            break
    return mu, direction


def pivot(
    backend: Backend, mobility: Array, speed: Array, limit: Array, direction: Array
) -> tuple[Array, Array, Scalar]:
    """Return the dry friction for given directions, and the directions after the first wrong one has changed.

    The arguments after the backend are those of stopping_torques, over its scalars.

    Returns:
        mu within its limits, shape (n,), in N m; the directions, shape (n,); and the condition that none was wrong.
    """
    less, select, rates = backend.less, backend.select, np.diagonal(mobility)
    held, sliding = backend.equal(direction, 0.0), direction * limit
    mu = select(held, backend.solve_chosen(mobility, speed - mobility @ sliding, held), sliding)
    left = speed - mobility @ mu
    too_much = select(held, backend.absolute(mu) - limit, -left * direction / rates)
    first, agrees = backend.first(less(_ROUNDING * (limit + backend.absolute(speed) / rates), too_much))

    def change() -> Array:
        return np.asarray(select(first, select(held, select(less(mu, 0.0), -1.0, 1.0), 0.0), direction))

    direction = backend.choose(agrees, lambda: direction, change)
    return select(less(limit, mu), limit, select(less(mu, -limit), -limit, mu)), direction, agrees
