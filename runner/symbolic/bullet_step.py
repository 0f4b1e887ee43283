"""Bullet's step of an arm on a fixed base, over any scalar and with Bullet's order of operations.

Numbers are rounded after each operation. Equal bits therefore need the same operations in the same order. They are
those of Bullet 3.27 in double precision (https://github.com/bulletphysics/bullet3, zlib licence: btMultiBody.cpp,
btMultiBodyLink.h, btSpatialAlgebra.h, btQuaternion.h, btMatrix3x3.h). Factors 0 and 1 need no operation; they change
at most the sign of a zero. The method is Featherstone's articulated-body algorithm in the form of Mirtich (1996).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from runner.symbolic.vectors import (
    Matrix,
    Scalar,
    Vector,
    add,
    cross,
    dot,
    matrix_product,
    minus,
    plus,
    product,
    scale,
    subtract,
    times,
    transpose,
)

VERSION = "3.27"
"""Version of Bullet."""
_AXES = range(3)
_ZERO: Vector = [0.0, 0.0, 0.0]
_EPSILON = 2.0**-52  # Bullet does not divide by smaller joint inertias

Quaternion = Sequence[Scalar]
"""A rotation, in the order x, y, z, w."""


class BulletLink(NamedTuple):
    """A link in the frame of its centre of mass and principal axes.

    Attributes:
        parent: Index of the parent link, which is smaller; None for the base.
        joint: Index of the joint's position; None for a fixed joint.
        mass: Mass, in kg.
        inertia: Principal moments of inertia, shape (3,), in kg m^2.
        angular: Angular velocity at a joint velocity of 1, shape (3,).
        linear: Velocity of the centre of mass at a joint velocity of 1, shape (3,).
        turn: Rotation from the parent's frame to this frame at joint position 0, for a revolute joint; else None.
        rotation: The same as a matrix, shape (3, 3), for other joints; else None.
        length: Norm of the axis of a revolute joint, 1 up to rounding.
        pivot: Vector from the parent's centre of mass to the joint, in the parent's frame, shape (3,), for a revolute
            joint.
        offset: Vector from the joint to the centre of mass for a revolute joint, from the parent's centre of mass at
            joint position 0 for others; shape (3,), in m.
    """

    parent: int | None
    joint: int | None
    mass: Scalar
    inertia: Vector
    angular: Vector
    linear: Vector
    turn: Quaternion | None
    rotation: Matrix | None
    length: Scalar
    pivot: Vector
    offset: Vector


class BulletArm(NamedTuple):
    """An arm as Bullet has it.

    Attributes:
        links: The links, fixed ones included.
        limits: Index, lower and upper limit of each joint with limits.
    """

    links: Sequence[BulletLink]
    limits: Sequence[tuple[int, Scalar, Scalar]]


def quaternion_product(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the product of two quaternions."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return [
        minus(dot([aw, ax, ay], [bx, bw, bz]), times(az, by)),
        minus(dot([aw, ay, az], [by, bw, bx]), times(ax, bz)),
        minus(dot([aw, az, ax], [bz, bw, by]), times(ay, bx)),
        minus(minus(minus(times(aw, bw), times(ax, bx)), times(ay, by)), times(az, bz)),
    ]


def inverse_quaternion(q: Quaternion) -> Quaternion:
    """Return the inverse of a unit quaternion."""
    x, y, z, w = q
    return [minus(0.0, x), minus(0.0, y), minus(0.0, z), w]


def rotate(q: Quaternion, v: Vector) -> Vector:
    """Return a rotated vector, shape (3,)."""
    (x, y, z, w), (a, b, c) = q, v
    turned = [
        minus(plus(times(w, a), times(y, c)), times(z, b)),
        minus(plus(times(w, b), times(z, a)), times(x, c)),
        minus(plus(times(w, c), times(x, b)), times(y, a)),
        minus(minus(times(minus(0.0, x), a), times(y, b)), times(z, c)),
    ]
    return quaternion_product(turned, inverse_quaternion(q))[:3]


def rotation_matrix(q: Quaternion) -> Matrix:
    """Return the matrix of a quaternion, shape (3, 3)."""
    x, y, z, w = q
    s = 2.0 / dot(q, q)
    xs, ys, zs = times(x, s), times(y, s), times(z, s)
    wx, wy, wz = times(w, xs), times(w, ys), times(w, zs)
    xx, xy, xz = times(x, xs), times(x, ys), times(x, zs)
    yy, yz, zz = times(y, ys), times(y, zs), times(z, zs)
    return [
        [minus(1.0, plus(yy, zz)), minus(xy, wz), plus(xz, wy)],
        [plus(xy, wz), minus(1.0, plus(xx, zz)), minus(yz, wx)],
        [minus(xz, wy), plus(yz, wx), minus(1.0, plus(xx, yy))],
    ]


@dataclass(frozen=True)
class Functions:
    """Functions of scalars that are not sums or products.

    Attributes:
        sine: Sine of an angle, in rad, by the same library as Bullet.
        cosine: Cosine of an angle, in rad, by the same library as Bullet.
        inverse_above: Function of x and a bound; it returns 1/x, or 0 if x is below the bound.
    """

    sine: Callable[[Scalar], Scalar]
    cosine: Callable[[Scalar], Scalar]
    inverse_above: Callable[[Scalar, float], Scalar]


class _Inertia(NamedTuple):
    """Articulated-body inertia: force = rows (coupling, mass), moment = rows (turning, coupling^T)."""

    coupling: Matrix
    mass: Matrix
    turning: Matrix

    def times(self, angular: Vector, linear: Vector) -> tuple[Vector, Vector]:
        """Return force and moment of an acceleration."""
        return (
            add(product(self.coupling, angular), product(self.mass, linear)),
            add(product(self.turning, angular), product(transpose(self.coupling), linear)),
        )


class BulletStep:
    """One step of an arm without contact and away from its joint limits.

    Args:
        arm: The arm.
        functions: Functions of the arm's scalars.
    """

    def __init__(self, arm: BulletArm, functions: Functions) -> None:
        self._arm, self._functions = arm, functions

    def advance(self, q: Vector, v: Vector, tau: Vector, gravity: Vector, dt: Scalar) -> tuple[Vector, Vector]:
        """Return the next joint positions and velocities, shapes (nq,), by semi-implicit Euler.

        Args:
            q: Joint positions, shape (nq,), in rad.
            v: Joint velocities, shape (nq,), in rad/s.
            tau: Joint torques, shape (nq,), in N m.
            gravity: Gravity vector, shape (3,), in m/s^2.
            dt: Step, in s.
        """
        accelerations = self._accelerations(q, v, tau, gravity)
        after = [plus(speed, times(a, dt)) for speed, a in zip(v, accelerations, strict=True)]
        return [plus(position, times(dt, speed)) for position, speed in zip(q, after, strict=True)], after

    def _accelerations(self, q: Vector, v: Vector, tau: Vector, gravity: Vector) -> Vector:
        links = self._arm.links
        rotations, offsets, drifts, forces, moments = self._outwards(q, v, gravity)
        inertias = [_Inertia([_ZERO] * 3, _diagonal([link.mass] * 3), _diagonal(link.inertia)) for link in links]
        pushes: list[tuple[Vector, Vector]] = [(_ZERO, _ZERO)] * len(links)  # force and moment of a joint acceleration
        rests: list[Scalar] = [0.0] * len(links)
        inverses: list[Scalar] = [0.0] * len(links)
        for i in reversed(range(len(links))):
            link, inertia = links[i], inertias[i]
            after = inertia
            drag = add(forces[i], inertia.times(*drifts[i])[0]), add(moments[i], inertia.times(*drifts[i])[1])
            if link.joint is not None:
                force, moment = pushes[i] = inertia.times(link.angular, link.linear)
                rests[i] = minus(
                    minus(tau[link.joint], _power(link.angular, link.linear, forces[i], moments[i])),
                    _power(*drifts[i], force, moment),
                )
                inverses[i] = self._functions.inverse_above(_power(link.angular, link.linear, force, moment), _EPSILON)
                lighter = scale(inverses[i], force), scale(inverses[i], moment)
                after = _Inertia(
                    _less_product(inertia.coupling, force, lighter[1]),
                    _less_product(inertia.mass, force, lighter[0]),
                    _less_product(inertia.turning, moment, lighter[1]),
                )
                free = times(inverses[i], rests[i])
                drag = add(drag[0], scale(free, force)), add(drag[1], scale(free, moment))
            if link.parent is None:
                continue
            parent, R, r = link.parent, rotations[i], offsets[i]
            inertias[parent] = _sum(inertias[parent], _carried(after, R, r))
            back = transpose(R)
            forces[parent] = add(forces[parent], product(back, drag[0]))
            moments[parent] = add(moments[parent], product(back, add(drag[1], cross(r, drag[0]))))
        return self._inwards(rotations, offsets, drifts, pushes, rests, inverses, len(tau))

    def _outwards(
        self, q: Vector, v: Vector, gravity: Vector
    ) -> tuple[list[Matrix], list[Vector], list[tuple[Vector, Vector]], list[Vector], list[Vector]]:
        """Return rotation, offset, velocity-dependent acceleration, force and moment of each link."""
        rotations: list[Matrix] = []
        offsets: list[Vector] = []
        drifts: list[tuple[Vector, Vector]] = []
        forces: list[Vector] = []
        moments: list[Vector] = []
        of_world: list[Matrix] = []
        spins: list[Vector] = []
        speeds: list[Vector] = []
        for link in self._arm.links:
            R, r = self._placement(link, q)
            of_world.append(R if link.parent is None else matrix_product(R, of_world[link.parent]))
            own_spin, own_speed, spin, speed = _ZERO, _ZERO, _ZERO, _ZERO
            if link.parent is not None:
                spin = product(R, spins[link.parent])
                speed = subtract(product(R, speeds[link.parent]), cross(r, spin))
            if link.joint is not None:
                own_spin, own_speed = scale(v[link.joint], link.angular), scale(v[link.joint], link.linear)
                spin, speed = add(spin, own_spin), add(speed, own_speed)
            drifts.append((cross(spin, own_spin), add(cross(speed, own_spin), cross(spin, own_speed))))
            weight = product(of_world[-1], scale(link.mass, gravity))
            forces.append(subtract(scale(link.mass, cross(spin, speed)), weight))
            moments.append(cross(spin, [times(a, b) for a, b in zip(link.inertia, spin, strict=True)]))
            rotations.append(R)
            offsets.append(r)
            spins.append(spin)
            speeds.append(speed)
        return rotations, offsets, drifts, forces, moments

    def _placement(self, link: BulletLink, q: Vector) -> tuple[Matrix, Vector]:
        """Return the rotation from the parent's frame to the link's, and the vector between their origins in it."""
        if link.turn is not None and link.joint is not None:
            half = times(minus(0.0, q[link.joint]), 0.5)
            s = self._functions.sine(half) / link.length
            about = [*(times(axis, s) for axis in link.angular), self._functions.cosine(half)]
            turned = quaternion_product(about, link.turn)
            return rotation_matrix(turned), add(link.offset, rotate(turned, link.pivot))
        assert link.rotation is not None  # noqa: S101
        moved = link.offset if link.joint is None else add(link.offset, scale(q[link.joint], link.linear))
        return link.rotation, moved

    def _inwards(
        self,
        rotations: Sequence[Matrix],
        offsets: Sequence[Vector],
        drifts: Sequence[tuple[Vector, Vector]],
        pushes: Sequence[tuple[Vector, Vector]],
        rests: Sequence[Scalar],
        inverses: Sequence[Scalar],
        count: int,
    ) -> Vector:
        """Return the joint accelerations, shape (count,)."""
        found: list[Scalar] = [0.0] * count
        accelerations: list[tuple[Vector, Vector]] = []
        for i, link in enumerate(self._arm.links):
            turning, moving = _ZERO, _ZERO
            if link.parent is not None:
                before = accelerations[link.parent]
                turning = product(rotations[i], before[0])
                moving = subtract(product(rotations[i], before[1]), cross(offsets[i], turning))
            left = rests[i] if link.joint is None else minus(rests[i], _power(turning, moving, *pushes[i]))
            turning, moving = add(turning, drifts[i][0]), add(moving, drifts[i][1])
            if link.joint is not None:
                found[link.joint] = own = times(inverses[i], left)
                turning, moving = add(turning, scale(own, link.angular)), add(moving, scale(own, link.linear))
            accelerations.append((turning, moving))
        return found


def _power(angular: Vector, linear: Vector, force: Vector, moment: Vector) -> Scalar:
    return plus(dot(linear, force), dot(angular, moment))


def _diagonal(values: Vector) -> Matrix:
    return [[values[i] if i == j else 0.0 for j in _AXES] for i in _AXES]


def _less_product(A: Matrix, a: Vector, b: Vector) -> Matrix:
    """Return A - a b^T."""
    return [[minus(A[i][j], times(a[i], b[j])) for j in _AXES] for i in _AXES]


def _add_matrices(A: Matrix, B: Matrix) -> Matrix:
    return [add(a, b) for a, b in zip(A, B, strict=True)]


def _subtract_matrices(A: Matrix, B: Matrix) -> Matrix:
    return [subtract(a, b) for a, b in zip(A, B, strict=True)]


def _sum(a: _Inertia, b: _Inertia) -> _Inertia:
    return _Inertia(*(_add_matrices(own, other) for own, other in zip(a, b, strict=True)))


def _carried(inertia: _Inertia, R: Matrix, r: Vector) -> _Inertia:
    """Return an inertia in the parent's frame.

    Args:
        inertia: Inertia in the link's frame.
        R: Rotation from the parent's frame to the link's, shape (3, 3).
        r: Vector from the parent's origin to the link's, in the link's frame, shape (3,).
    """
    back = transpose(R)
    lever = [[0.0, minus(0.0, r[2]), r[1]], [r[2], 0.0, minus(0.0, r[0])], [minus(0.0, r[1]), r[0], 0.0]]
    coupling = _subtract_matrices(inertia.coupling, matrix_product(inertia.mass, lever))
    turning = _subtract_matrices(
        _add_matrices(matrix_product(lever, coupling), inertia.turning),
        matrix_product(transpose(inertia.coupling), lever),
    )
    return _Inertia(*(matrix_product(matrix_product(back, A), R) for A in (coupling, inertia.mass, turning)))
