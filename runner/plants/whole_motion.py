"""Compiled motion of a robot between two ticks: Runge-Kutta with joint friction, or Bullet's step."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from runner.plants.compiled_bullet import bullet_scalars, expressed_steps
from runner.plants.compiled_motion import Mover
from runner.plants.decoupled import Motion
from runner.plants.friction import MOST_PIVOTS, pivot
from runner.plants.friction_law import JointFriction
from runner.robots.robot import StageBase
from runner.symbolic.algebra import ArmAlgebra, Factors
from runner.symbolic.arm import ArmConstants, constants_of
from runner.symbolic.backend import SymbolicBackend
from runner.symbolic.bullet_step import BulletArm
from runner.symbolic.code import SCRATCH, STATE, Block, Part, Repeat, Slots, put
from runner.symbolic.expression import Value, equal, places, select
from runner.symbolic.structure import any_number
from runner.symbolic.vectors import Vector, add, as_array, product, scale, subtract, transpose


class ArmScalars(NamedTuple):
    """Parameters of an arm that moves by its own dynamics.

    Attributes:
        constants: Constants of its bodies.
        friction: Friction of its joints.
        base: Constants of the bodies from the robot's base to this arm's base; None if the base does not rotate.
    """

    constants: ArmConstants
    friction: JointFriction
    base: ArmConstants | None


class MotionScalars(NamedTuple):
    """Parameters of a motion.

    Attributes:
        step: Integration step, in s.
        tick: Time for which torques are held, in s.
        gravity: Gravity vector in the robot's base frame, shape (3,), in m/s^2.
        arms: Parameters of each arm; the constants of an arm whose base does not rotate include a constant gravity
            vector.
        bullet: An arm as Bullet has it, instead of `arms`, and its constants if it has armature; None otherwise.
    """

    step: Value
    tick: Value
    gravity: Vector
    arms: tuple[ArmScalars, ...]
    bullet: tuple[BulletArm, ArmConstants | None] | None = None


def motion_scalars(motion: Motion, step: float, tick: float, number: Callable[[float], Any]) -> MotionScalars:
    """Return the parameters of a motion as scalars.

    Args:
        motion: The motion.
        step: Integration step, in s.
        tick: Time for which torques are held, in s.
        number: Function that returns the scalar for a number; it is not called for 0, 1 and -1.
    """
    robot = motion.robot
    gravity = [number(value) for value in robot.model.gravity.tolist()]
    if motion.bullet is not None:
        model = motion.arms[0].model
        inertias = constants_of(model, number, gravity) if model.armature.any() else None
        bullet = bullet_scalars(motion.bullet.arm, number), inertias
        return MotionScalars(number(motion.bullet.step), number(tick), gravity, (), bullet)
    arms = []
    for index, arm in enumerate(motion.arms):
        own, base = gravity, None
        if index and motion.ignore_base_rotation:
            fixed = StageBase(robot, index, ignore_base_rotation=True).rotation.T.dot(robot.model.gravity)
            own = [number(value) for value in fixed.tolist()]
        elif index:
            base = constants_of(robot.model, number, [0.0] * 3, str(robot.stages[index].base_frame))
        constants = constants_of(arm.model, number, own)
        arms.append(ArmScalars(constants, arm.friction.convert(number), base))
    return MotionScalars(number(step), number(tick), gravity, tuple(arms))


def motion_pattern(motion: Motion) -> str:
    """Return a string that is the same for two motions with the same code."""
    return repr((motion_scalars(motion, 0.5, 0.5, any_number), [arm.joints for arm in motion.arms]))


def expressed_motion(motion: Motion, numbers: MotionScalars, at: Slots, torques: Sequence[Value]) -> list[Part]:
    """Return the code from the state of one tick to that of the next.

    Args:
        motion: The motion.
        numbers: Parameters of the motion.
        at: Allocator of slots; the state begins with joint positions and velocities, shapes (nq,).
        torques: Acting torques, shape (nq,).
    """
    nq = motion.robot.model.nq
    if numbers.bullet is not None:
        return expressed_steps(*numbers.bullet, torques, numbers.gravity, numbers.step, at)
    bases: list[Part] = []
    arms: list[Part] = []
    for arm, own in zip(motion.arms, numbers.arms, strict=True):
        constants = own.constants
        if own.base is not None:
            # Gravity on a mounted stage follows the rotation of its base at the start of the tick.
            whole = ArmAlgebra(own.base).tip(places(STATE, 0, nq), [0.0] * nq)
            first, gravity = at.take(SCRATCH, 3)
            bases.append(put(SCRATCH, first, product(transpose(whole[1]), numbers.gravity)))
            constants = constants._replace(gravity=gravity)
        joint, count = arm.joints.start, arm.model.nq
        algebra = ArmAlgebra(constants)
        acting: Vector = torques[joint : joint + count]
        if arm.friction.acts.any():
            state = places(STATE, joint, count), places(STATE, nq + joint, count)
            acting = _brake(algebra, own.friction, state, acting, numbers.tick, at, arms)
        Mover(algebra, joint, nq, count, at).move(acting, numbers.step, arms)
    return [*bases, *arms]


def _brake(
    algebra: ArmAlgebra,
    law: JointFriction,
    motion: tuple[Vector, Vector],
    acting: Vector,
    h: Value,
    at: Slots,
    parts: list[Part],
) -> Vector:
    """Add a tick's friction in n joints by backward Euler; return the torques minus friction. See Frictional.

    Args:
        algebra: Algebra of the arm.
        law: Friction of the joints.
        motion: Joint positions and velocities, shapes (n,).
        acting: Torques without friction, shape (n,).
        h: Duration of the tick.
        at: Allocator of slots.
        parts: Code before this one; the function adds to it.
    """
    (q, v), n, backend = motion, len(acting), SymbolicBackend()
    state, direction = at.take(STATE, n if law.dry else 0)
    damping, level = law.at(backend, v, [equal(side, 0.0) for side in direction])
    kept = at.keep([*damping, *level], parts)
    damping, level = kept[:n], kept[n:]
    M = algebra.mass_matrix(q)
    acting = subtract(acting, law.asymmetry)
    pushed = add(product(M, v), scale(h, subtract(acting, algebra.inverse_dynamics(q, v, [0.0] * n))))
    factors = Factors([[M[i][j] + h * damping[i] if i == j else M[i][j] for j in range(n)] for i in range(n)])
    columns = [factors.solve([h if i == j else 0.0 for i in range(n)]) for j in range(n)]
    kept = at.keep([*factors.solve(pushed), *(columns[j][i] for i in range(n) for j in range(n))], parts)
    speed, A = as_array(kept[:n]), as_array(kept[n:]).reshape(n, n)
    mu = np.zeros(n)
    if law.dry:
        first, slots = at.take(SCRATCH, n + 1)
        found, sides, agrees = pivot(backend, A, speed, as_array(level), as_array(direction))
        search = [put(STATE, state, sides.tolist()), put(SCRATCH, first, [*found, select(agrees, 0.0, 1.0)])]
        parts.append(Repeat([Block([*search[0].outputs, *search[1].outputs])], MOST_PIVOTS, until_zero=first + n))
        mu = as_array(slots[:n])
    drag = as_array(damping) * (speed - A @ mu)
    return at.keep(subtract(subtract(acting, drag.tolist()), mu.tolist()), parts)
