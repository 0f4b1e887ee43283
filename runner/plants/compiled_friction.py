"""Compiled friction of an arm's joints over a tick; see runner/plants/friction.py."""

import numpy as np

from runner.plants.friction import MOST_PIVOTS, pivot
from runner.plants.friction_law import JointFriction
from runner.symbolic.algebra import ArmAlgebra, Factors
from runner.symbolic.backend import SymbolicBackend
from runner.symbolic.code import SCRATCH, STATE, Block, Part, Repeat, Slots, put
from runner.symbolic.expression import Value, equal, select
from runner.symbolic.vectors import Vector, add, as_array, product, scale, subtract


def brake(
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
