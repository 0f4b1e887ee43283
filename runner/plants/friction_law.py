"""Friction laws of joints: viscous, dry with a static level, Stribeck's curve, and a sigmoid."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from runner.base import portable
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.memory import Memory
from runner.schema.values import FrictionConfig, expand
from runner.symbolic.arm import to_scalars
from runner.symbolic.maths import Backend
from runner.symbolic.vectors import Matrix, Scalar, Vector, is_number

_STEEPEST = 700.0  # exp of it is a double
_EXPONENTS = {"exponential": 1, "gauss": 2}
_MEMORY = Memory(256)


class JointFriction(NamedTuple):
    r"""Friction torques of n joints against their speeds v.

    .. math:: \tau_f = -b v - \sigma(v) - \mu, \quad \mu \in o + [c + (s - c) w(v)] \, \mathrm{sgn}(v), \qquad
        w(v) = e^{-(|v| / v_s)^e}, \quad
        \sigma(v) = \frac{\phi_1}{1 + e^{-\phi_2 (v + \phi_3)}} - \frac{\phi_1}{1 + e^{-\phi_2 \phi_3}}

    At rest sgn is any number of [-1, 1] and w is 1. w is the curve of Armstrong-Helouvry, Dupont and Canudas de Wit
    (Automatica 30(7), 1994), sigma that of Gaz et al. (IEEE Robotics and Automation Letters 4(4), 2019).

    The numbers are floats, or expressions for a program.

    Attributes:
        viscous: b, shape (n,), in N m s/rad.
        coulomb: c, shape (n,), in N m.
        asymmetry: o, shape (n,), in N m, at most c in magnitude.
        stiction: s - c, shape (n,), in N m; s is the static level.
        steepness: phi_2, shape (n,), in s/rad.
        odds: exp(-phi_2 phi_3) for joints that move up, and its inverse for those that move down, shape (2, n).
        slopes: phi_1 phi_2 odds / (1 + odds), shape (2, n), in N m s/rad.
        stribeck_speed: v_s, shape (n,), in rad/s; None if w is 0 in motion.
        exponent: e, 1 or 2.
    """

    viscous: Vector
    coulomb: Vector
    asymmetry: Vector
    stiction: Vector
    steepness: Vector
    odds: Matrix
    slopes: Matrix
    stribeck_speed: Sequence[Scalar | None]
    exponent: int

    @property
    def acts(self) -> NDArray[np.bool_]:
        """True for each joint with friction, shape (n,)."""
        found: NDArray[np.bool_] = np.any(np.array([*self[:2], self.stiction, self.slopes[0]]) > 0.0, axis=0)
        return found

    @property
    def dry(self) -> bool:
        """Whether a joint has dry friction."""
        return not all(is_number(value, 0.0) for value in [*self.coulomb, *self.stiction])

    def of(self, joints: slice | NDArray[np.bool_]) -> "JointFriction":
        """Return the friction of some of the joints."""
        parts = (np.array(part, dtype=object)[..., joints].tolist() for part in self[:-1])
        return JointFriction._make([*parts, self.exponent])

    def convert(self, number: Callable[[float], Scalar]) -> "JointFriction":
        """Return the numbers converted by `number`; 0, 1 and -1 stay floats."""
        arrays = {name: to_scalars(getattr(self, name), number) for name in self._fields[:-2]}
        speeds = [to_scalars(speed, number) if speed else None for speed in self.stribeck_speed]
        return self._replace(**arrays, stribeck_speed=speeds)

    def at(self, backend: Backend, v: Vector, held: Sequence[Scalar]) -> tuple[Vector, Vector]:
        """Return the law that holds for a tick from its first speeds on.

        The sigmoid becomes its secant through the origin, sigma(v) / v. So no part of friction can drive a joint.

        Args:
            backend: Functions over these numbers.
            v: Speeds at the start of the tick, shape (n,), in rad/s.
            held: Conditions that the joints are at rest, shape (n,).

        Returns:
            Torque per speed, in N m s/rad, and level of dry friction, in N m, of each joint, shapes (n,).
        """
        damping, level = list(self.viscous), list(self.coulomb)
        for joint, speed in enumerate(v):
            if not is_number(self.slopes[0][joint], 0.0):
                damping[joint] = damping[joint] + self._secant(backend, joint, speed)
            if not is_number(self.stiction[joint], 0.0):
                weight = backend.select(held[joint], 1.0, self._weight(backend, joint, speed))
                level[joint] = level[joint] + self.stiction[joint] * weight
        return damping, level

    def _weight(self, backend: Backend, joint: int, v: Scalar) -> Scalar:
        """Return w of a joint in motion."""
        falls = self.stribeck_speed[joint]
        if falls is None:
            return 0.0
        share = backend.absolute(v) / falls
        return backend.decay(share if self.exponent == 1 else share * share)[0]

    def _secant(self, backend: Backend, joint: int, v: Scalar) -> Scalar:
        """Return sigma(v) / v of a joint, in N m s/rad."""
        down, y = backend.less(v, 0.0), self.steepness[joint] * backend.absolute(v)
        slope, odds = (
            backend.select(down, of_joint[1][joint], of_joint[0][joint]) for of_joint in (self.slopes, self.odds)
        )
        (left, gone), rests = backend.decay(y), backend.equal(y, 0.0)
        share = backend.select(rests, 1.0, gone / backend.select(rests, 1.0, y))
        return slope * share / (1.0 + odds * left)


def joint_friction(key: str, config: FrictionConfig, joints: Sequence[str]) -> JointFriction:
    """Return the friction of each joint, which runs with the same friction share and must not change.

    Args:
        key: Key of the config, such as plant.friction.
        config: The config.
        joints: Names of the joints, shape (n,).

    Raises:
        ConfigError: for a list of the wrong length, an unknown joint, a static level below the Coulomb level, an
            asymmetry above it, or a sigmoid that is too steep for its shift.
    """
    return _MEMORY.recall(_joint_friction, key, config, *joints)


def _joint_friction(key: str, config: FrictionConfig, *joints: str) -> JointFriction:
    def array(name: str, value: Any) -> FloatArray:
        return np.array(expand(f"{key}.{name}", value, joints))

    coulomb = array("coulomb", config.coulomb)
    asymmetry = array("asymmetry", 0.0 if config.asymmetry is None else config.asymmetry)
    static = coulomb if config.static is None else array("static", config.static)
    if isinstance(config.static, dict):
        static = np.where([joint in config.static for joint in joints], static, coulomb)
    speed = 0.0 if config.stribeck_speed is None else config.stribeck_speed
    sigmoid = np.array([array(f"sigmoid.{name}", value) for name, value in config.sigmoid])
    problems = [
        f"{key}.static: {static[i]:g} of {joints[i]} is below {key}.coulomb, {coulomb[i]:g}; a joint at rest is held "
        "by as much as a moving one or more"
        for i in np.flatnonzero(static < coulomb).tolist()
    ]
    problems += [
        f"{key}.asymmetry: {asymmetry[i]:g} of {joints[i]} is more than {key}.coulomb, {coulomb[i]:g}; such friction "
        "would drive the joint"
        for i in np.flatnonzero(np.abs(asymmetry) > coulomb).tolist()
    ]
    problems += [
        f"{key}.sigmoid.shift: {sigmoid[2, i]:g} of {joints[i]} times {key}.sigmoid.steepness, {sigmoid[1, i]:g}, must "
        f"be within {_STEEPEST:g} in magnitude"
        for i in np.flatnonzero(np.abs(sigmoid[1] * sigmoid[2]) > _STEEPEST).tolist()
    ]
    if problems:
        raise ConfigError(problems)
    odds = portable.exp(np.array([[-1.0], [1.0]]) * sigmoid[1] * sigmoid[2])
    return JointFriction(
        viscous=array("viscous", config.viscous).tolist(),
        coulomb=coulomb.tolist(),
        asymmetry=asymmetry.tolist(),
        stiction=(static - coulomb).tolist(),
        steepness=sigmoid[1].tolist(),
        odds=odds.tolist(),
        slopes=(sigmoid[0] * sigmoid[1] * odds / (1.0 + odds)).tolist(),
        stribeck_speed=[value or None for value in array("stribeck_speed", speed).tolist()],
        exponent=_EXPONENTS[config.stribeck_curve],
    )
