"""Joint torque regressor of the inertial parameters, for any scalar type."""

from collections.abc import Sequence
from typing import NamedTuple

from runner.symbolic.arm import Body
from runner.symbolic.vectors import (
    Matrix,
    Scalar,
    Vector,
    add,
    cross,
    dot,
    minus,
    plus,
    product,
    subtract,
    times,
    transpose,
)

COUNT = 10
"""Number of inertial parameters of a body."""

_ZERO: Vector = [0.0, 0.0, 0.0]
_Z: Vector = [0.0, 0.0, 1.0]
_PAIRS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))  # entries of the inertia, in Pinocchio's order


class Moved(NamedTuple):
    """Motion of a body, along the axes of its frame.

    Attributes:
        spin: Angular velocity, shape (3,), in rad/s.
        turning: Angular acceleration, shape (3,), in rad/s^2.
        acceleration: Linear acceleration of the origin, shape (3,), in m/s^2.
    """

    spin: Vector
    turning: Vector
    acceleration: Vector


def regressor(
    bodies: Sequence[Body],
    placements: Sequence[tuple[Matrix, Vector]],
    motions: Sequence[Moved],
    others: Sequence[Moved],
) -> Matrix:
    """Return the difference of the joint torques of two sets of motions, by parameter, shape (nq, 10 nq).

    Args:
        bodies: The moving links, base first.
        placements: Rotation and origin of each body in its parent's frame.
        motions: Motion of each body.
        others: Motion of each body whose torques are subtracted.
    """
    Y: list[list[Scalar]] = [[0.0] * (COUNT * len(bodies)) for _ in bodies]
    driven: list[dict[int, tuple[Vector, Vector]]] = []
    for index, (body, (R, p)) in enumerate(zip(bodies, placements, strict=True)):
        # Angular and linear velocity of the origin at unit velocity of each joint between base and body.
        back, carried = transpose(R), {} if body.parent is None else driven[body.parent]
        own = {i: (product(back, w), product(back, add(v, cross(w, p)))) for i, (w, v) in carried.items()}
        own[index] = (_ZERO, _Z) if body.prismatic else (_Z, _ZERO)
        driven.append(own)
        first, other = (Moved(*(product(body.turn, way) for way in moved)) for moved in (motions[index], others[index]))
        for joint, (w, v) in own.items():
            columns = _columns(first, other, product(body.turn, w), product(body.turn, v))
            Y[joint][COUNT * index : COUNT * (index + 1)] = columns
    return Y


def _columns(one: Moved, other: Moved, w: Vector, v: Vector) -> Vector:
    """Return the power at w and v of a motion's wrench minus that of another motion, by parameter."""
    a = subtract(one.acceleration, other.acceleration)
    turning = subtract(one.turning, other.turning)
    # A first moment h requires the force (dw/dt x + w x w x) h and the moment h x a.
    pull = [subtract(x, y) for x, y in zip(_whirl(one.spin), _whirl(other.spin), strict=True)]
    by_moment = add(cross(v, turning), product(transpose(pull), v), cross(a, w))
    # An inertia requires the moment I dw/dt + w x I w.
    across = cross(w, one.spin), cross(w, other.spin)
    inertias = [
        minus(plus(_entry(w, turning, pair), _entry(across[0], one.spin, pair)), _entry(across[1], other.spin, pair))
        for pair in _PAIRS
    ]
    return [dot(v, a), *by_moment, *inertias]


def _whirl(w: Vector) -> Matrix:
    """Return the matrix of w x (w x h)."""
    return [[minus(times(w[i], w[j]), dot(w, w)) if i == j else times(w[i], w[j]) for j in range(3)] for i in range(3)]


def _entry(left: Vector, right: Vector, pair: tuple[int, int]) -> Scalar:
    """Return the derivative of left^T I right by an entry of a symmetric I, which occurs twice off the diagonal."""
    i, j = pair
    if i == j:
        return times(left[i], right[i])
    return plus(times(left[i], right[j]), times(left[j], right[i]))
