"""Compiled friction of an arm's joints over a tick; see runner/plants/friction.py."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from runner.plants.friction_law import JointFriction
from runner.symbolic.algebra import ArmAlgebra, Factors
from runner.symbolic.arm import to_scalars
from runner.symbolic.code import SCRATCH, STATE, Block, Part, Repeat, Slots, put
from runner.symbolic.expression import Value, absolute, both, decay, equal, less, places, select
from runner.symbolic.vectors import Matrix, Vector, add, product, scale, subtract

_PIVOTS, _ROUNDING = 100, 1e-12  # as in runner/plants/friction.py


class FrictionScalars(NamedTuple):
    """Friction of n joints; see JointFriction.

    Attributes:
        viscous: b, shape (n,).
        coulomb: c, shape (n,).
        asymmetry: o, shape (n,).
        stiction: s - c, shape (n,).
        stribeck_speed: v_s, shape (n,); None for a joint whose friction falls as soon as it moves.
        exponent: e.
        steepness: phi_2, shape (n,).
        odds: Odds of the sigmoid for joints that move up and down, shape (2, n).
        slopes: Slopes of the sigmoid for joints that move up and down, shape (2, n).
    """

    viscous: Vector
    coulomb: Vector
    asymmetry: Vector
    stiction: Vector
    stribeck_speed: Sequence[Value | None]
    exponent: int
    steepness: Vector
    odds: Sequence[Vector]
    slopes: Sequence[Vector]


def friction_scalars(law: JointFriction, number: Callable[[float], Any]) -> FrictionScalars:
    """Return the friction of joints, converted by `number`."""
    viscous, coulomb, asymmetry, stiction, steepness, odds, slopes = (
        to_scalars(values, number)
        for values in (law.viscous, law.coulomb, law.asymmetry, law.stiction, law.sigmoid[1], law.odds, law.slopes)
    )
    speeds = [to_scalars(speed, number) if speed else None for speed in law.stribeck_speed.tolist()]
    return FrictionScalars(viscous, coulomb, asymmetry, stiction, speeds, law.exponent, steepness, odds, slopes)


@dataclass(frozen=True)
class CompiledFriction:
    """Code of the friction in an arm's n joints; see Frictional.

    Attributes:
        algebra: Algebra of the arm.
        law: Friction of the joints.
        q: Joint positions, shape (n,).
        v: Joint velocities, shape (n,).
        at: Allocator of slots.
    """

    algebra: ArmAlgebra
    law: FrictionScalars
    q: Vector
    v: Vector
    at: Slots

    def brake(self, acting: Vector, h: Value, parts: list[Part]) -> Vector:
        """Add a tick's friction by backward Euler; return the torques minus friction.

        Args:
            acting: Torques without friction, shape (n,).
            h: Duration of the tick.
            parts: Code before this one; the method adds to it.
        """
        algebra, law, q, v, at = self.algebra, self.law, self.q, self.v, self.at
        n = len(q)
        dry = any(value != 0.0 for value in [*law.coulomb, *law.stiction])
        state, direction = at.take(STATE, n if dry else 0)
        damping, level = self._law_of_tick(direction, parts)
        M = algebra.mass_matrix(q)
        bias = algebra.inverse_dynamics(q, v, [0.0] * n)
        acting = subtract(acting, law.asymmetry)
        pushed = add(product(M, v), scale(h, subtract(acting, bias)))
        braked = [[M[i][j] + h * damping[i] if i == j else M[i][j] for j in range(n)] for i in range(n)]
        factors = Factors(braked)
        columns = [factors.solve([h if i == j else 0.0 for i in range(n)]) for j in range(n)]
        first, scratch = at.take(SCRATCH, n + n * n + n + 1)
        speed, mobility = scratch[:n], scratch[n : n + n * n]
        mu: Vector = scratch[n + n * n : 2 * n + n * n]
        A = [mobility[i * n : (i + 1) * n] for i in range(n)]
        found = [*factors.solve(pushed), *(columns[j][i] for i in range(n) for j in range(n))]
        parts.append(put(SCRATCH, first, found))
        if dry:
            self._pivot(A, speed, mu, level, (first + n + n * n, state), parts)
        else:
            mu = [0.0] * n
        braked_speed = subtract(speed, product(A, mu))
        first, less_friction = at.take(SCRATCH, n)
        drag = [b * w for b, w in zip(damping, braked_speed, strict=True)]
        parts.append(put(SCRATCH, first, subtract(subtract(acting, drag), mu)))
        return less_friction

    def _law_of_tick(self, direction: Vector, parts: list[Part]) -> tuple[Vector, Vector]:
        """Add a tick's torque per speed and level of dry friction, shapes (n,); see JointFriction.at."""
        damping, level = list(self.law.viscous), list(self.law.coulomb)
        outputs: list[tuple[str, int, Value]] = []
        for i in range(len(self.v)):
            for own, more in ((damping, self._secant(i)), (level, self._more_level(i, direction))):
                if more != 0.0:
                    slot, (kept,) = self.at.take(SCRATCH, 1)
                    outputs.append((SCRATCH, slot, own[i] + more))
                    own[i] = kept
        if outputs:
            parts.append(Block(outputs))
        return damping, level

    def _pivot(
        self, A: Matrix, speed: Vector, mu: Vector, limit: Vector, firsts: tuple[int, int], parts: list[Part]
    ) -> None:
        """Add the search for the torques that stop joints; see `stopping_torques` of runner/plants/friction.py."""
        n, (first, state) = len(mu), firsts
        direction = places(STATE, state, n)
        held = [equal(side, 0.0) for side in direction]
        sliding = [side * c for side, c in zip(direction, limit, strict=True)]
        left = subtract(speed, product(A, sliding))
        # A moving joint has a row with only a one on the diagonal.
        system = [
            [
                select(held[i], A[i][i], 1.0) if i == j else select(both(held[i], held[j]), A[i][j], 0.0)
                for j in range(n)
            ]
            for i in range(n)
        ]
        stopping = Factors(system).solve([select(held[i], left[i], 0.0) for i in range(n)])
        now = [select(held[i], stopping[i], sliding[i]) for i in range(n)]
        left = subtract(speed, product(A, now))
        wrong, sides = [], []
        for i in range(n):
            too_much = select(held[i], absolute(now[i]) - limit[i], -left[i] * direction[i] / A[i][i])
            wrong.append(less(_ROUNDING * (limit[i] + absolute(speed[i]) / A[i][i]), too_much))
            sides.append(select(held[i], select(less(now[i], 0.0), -1.0, 1.0), 0.0))
        outputs: list[tuple[str, int, Any]] = []
        open_: Value = 1.0  # 1 if no earlier joint is on the wrong side
        for i in range(n):
            outputs.append(
                (STATE, state + i, select(wrong[i], select(equal(open_, 1.0), sides[i], direction[i]), direction[i]))
            )
            open_ = select(wrong[i], 0.0, open_)
            clipped = select(less(limit[i], now[i]), limit[i], select(less(now[i], -limit[i]), -limit[i], now[i]))
            outputs.append((SCRATCH, first + i, clipped))
        outputs.append((SCRATCH, first + n, 1.0 - open_))
        parts.append(Repeat([Block(outputs)], _PIVOTS, until_zero=first + n))

    def _secant(self, joint: int) -> Value:
        """Return the secant of a joint's sigmoid, in N m s/rad; see JointFriction."""
        law, v = self.law, self.v[joint]
        up, down = (slopes[joint] for slopes in law.slopes)
        if up == 0.0:
            return 0.0
        falls, y = less(v, 0.0), law.steepness[joint] * absolute(v)
        left, gone = decay(y)
        odds = select(falls, law.odds[1][joint], law.odds[0][joint])
        share = select(equal(y, 0.0), 1.0, gone / y)
        return select(falls, down, up) * share / (1.0 + odds * left)

    def _more_level(self, joint: int, direction: Vector) -> Value:
        """Return by how much a joint's dry friction exceeds its Coulomb level, in N m; see JointFriction."""
        law = self.law
        weight: Value = 0.0
        if law.stiction[joint] == 0.0:
            return 0.0
        speed = law.stribeck_speed[joint]
        if speed is not None:
            share = absolute(self.v[joint]) / speed
            weight = decay(share if law.exponent == 1 else share * share)[0]
        more: Value = law.stiction[joint] * select(equal(direction[joint], 0.0), 1.0, weight)
        return more
