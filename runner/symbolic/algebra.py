"""Recursive kinematics and dynamics of an arm, for any scalar type, and end points of a robot's stages."""

from collections.abc import Callable
from typing import Any, NamedTuple

from runner.robots.robot import Robot, StageBase
from runner.symbolic.arm import ArmConstants, Body, constants_of
from runner.symbolic.expression import Value, sine_cosine
from runner.symbolic.regressor import Moved, regressor
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
    rotate_tensor,
    scale,
    shift_inertia,
    subtract,
    times,
    transpose,
)

_ZERO: Vector = [0.0, 0.0, 0.0]
_Z: Vector = [0.0, 0.0, 1.0]
_IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], _Z]


class ArmAlgebra:
    """Kinematics and dynamics of an arm as sums and products of scalars (Featherstone 2008, chapters 5 and 6).

    Args:
        constants: Bodies, tip and gravity of the arm.
        sine_cosine: Function that returns sine and cosine of a scalar.
    """

    def __init__(
        self, constants: ArmConstants, sine_cosine: Callable[[Scalar], tuple[Scalar, Scalar]] = sine_cosine
    ) -> None:
        self._constants, self._sine_cosine = constants, sine_cosine
        self._placed: tuple[Vector, list[tuple[Matrix, Vector]]] | None = None

    def tip(self, q: Vector, dq: Vector) -> tuple[Vector, Matrix, Matrix, Vector]:
        """Return the tip's position, rotation, Jacobian and dJ/dt dq in the base frame.

        Args:
            q: Joint positions, shape (nq,), in rad.
            dq: Joint velocities, shape (nq,), in rad/s.

        Returns:
            Arrays of shapes (3,), (3, 3), (6, nq) and (6,), linear rows first.
        """
        constants, placements = self._constants, self._placements(q)
        rotations: list[Matrix] = []
        origins: list[Vector] = []
        for body, (R, p) in zip(constants.bodies, placements, strict=True):
            at = _IDENTITY if body.parent is None else rotations[body.parent]
            rotations.append(matrix_product(at, R))
            origins.append(add(_ZERO if body.parent is None else origins[body.parent], product(at, p)))
        last = constants.tip_body
        x = add(origins[last], product(rotations[last], constants.tip_position))
        columns: list[Vector] = [[0.0] * 6 for _ in q]
        parent: int | None = last
        while parent is not None:
            body = constants.bodies[parent]
            axis = [row[2] for row in rotations[parent]]
            columns[parent] = [*axis, *_ZERO] if body.prismatic else [*cross(axis, subtract(x, origins[parent])), *axis]
            parent = body.parent
        moved = self._motions(placements, dq, [0.0] * len(q), _ZERO)[last]
        lever = constants.tip_position
        own = add(moved.acceleration, cross(moved.turning, lever), cross(moved.spin, cross(moved.spin, lever)))
        bias = [*product(rotations[last], own), *product(rotations[last], moved.turning)]
        return x, matrix_product(rotations[last], constants.tip_rotation), transpose(columns), bias

    def inverse_dynamics(self, q: Vector, dq: Vector, ddq: Vector, gravity: Vector | None = None) -> Vector:
        """Return the joint torques M ddq + V + G, shape (nq,), in N m, by the recursive Newton-Euler algorithm.

        Args:
            q: Joint positions, shape (nq,), in rad.
            dq: Joint velocities, shape (nq,), in rad/s.
            ddq: Joint accelerations, shape (nq,), in rad/s^2.
            gravity: Gravity vector in the base frame, shape (3,), in m/s^2; None for that of the arm.
        """
        bodies, placements = self._constants.bodies, self._placements(q)
        upwards = scale(-1.0, self._constants.gravity if gravity is None else gravity)
        motions = self._motions(placements, dq, ddq, upwards)
        forces: list[Vector] = []
        moments: list[Vector] = []
        for body, motion in zip(bodies, motions, strict=True):
            w, turning, a = motion.spin, motion.turning, motion.acceleration
            forces.append(add(scale(body.mass, a), cross(turning, body.moment), cross(w, cross(w, body.moment))))
            moments.append(
                add(product(body.inertia, turning), cross(w, product(body.inertia, w)), cross(body.moment, a))
            )
        torques: list[Scalar] = [0.0] * len(bodies)
        for index in reversed(range(len(bodies))):
            body, (R, p) = bodies[index], placements[index]
            torque = forces[index][2] if body.prismatic else moments[index][2]
            torques[index] = plus(torque, times(body.armature, ddq[index]))
            if body.parent is not None:
                force = product(R, forces[index])
                forces[body.parent] = add(forces[body.parent], force)
                moments[body.parent] = add(moments[body.parent], product(R, moments[index]), cross(p, force))
        return torques

    def momentum(self, q: Vector, dq: Vector, gravity: Vector) -> tuple[Vector, Vector]:
        """Return M dq and dT/dq - G, shapes (nq,); see Arm.momentum.

        Both follow from the momentum h of the bodies that a joint moves (Featherstone 2008, chapter 2). For a joint S
        whose body has the velocity V, they are S^T h and h^T (V x S), because a joint displacement changes the velocity
        of these bodies by V x S.
        """
        bodies, placements = self._constants.bodies, self._placements(q)
        speeds: list[tuple[Vector, Vector, Vector]] = []  # spin, velocity of the origin, and gravity
        sums: list[list[Vector]] = []  # linear and angular momentum; force and moment of the weight
        for body, (R, p), speed in zip(bodies, placements, dq, strict=True):
            w, v, g = (_ZERO, _ZERO, gravity) if body.parent is None else speeds[body.parent]
            back, own = transpose(R), [0.0, 0.0, speed]
            w, v, g = product(back, w), product(back, add(v, cross(w, p))), product(back, g)
            w, v = (w, add(v, own)) if body.prismatic else (add(w, own), v)
            speeds.append((w, v, g))
            linear = add(scale(body.mass, v), cross(w, body.moment))
            angular = add(cross(body.moment, v), product(body.inertia, w))
            sums.append([linear, angular, scale(body.mass, g), cross(body.moment, g)])
        p_joint: list[Scalar] = [0.0] * len(bodies)
        rates: list[Scalar] = [0.0] * len(bodies)
        for index in reversed(range(len(bodies))):
            body, (R, at), (w, v, _) = bodies[index], placements[index], speeds[index]
            linear, angular, weight, moment = sums[index]
            p_joint[index] = plus(linear[2] if body.prismatic else angular[2], times(body.armature, dq[index]))
            turned_way = dot(linear if body.prismatic else angular, cross(w, _Z))
            turned_way = turned_way if body.prismatic else plus(turned_way, dot(linear, cross(v, _Z)))
            rates[index] = plus(turned_way, weight[2] if body.prismatic else moment[2])
            if body.parent is not None:
                for force, about in ((0, 1), (2, 3)):
                    pushed = product(R, sums[index][force])
                    carried = sums[body.parent]
                    carried[about] = add(carried[about], product(R, sums[index][about]), cross(at, pushed))
                    carried[force] = add(carried[force], pushed)
        return p_joint, rates

    def regressor(self, q: Vector, dq: Vector, dq_r: Vector, ddq_r: Vector) -> Matrix:
        """Return Y, shape (nq, 10 nq); see Arm.regressor."""
        placements, rest = self._placements(q), [0.0] * len(q)
        mean, half = (scale(0.5, pick(dq, dq_r)) for pick in (add, subtract))
        motions = self._motions(placements, mean, ddq_r, scale(-1.0, self._constants.gravity))
        return regressor(self._constants.bodies, placements, motions, self._motions(placements, half, rest, _ZERO))

    def mass_matrix(self, q: Vector) -> Matrix:
        """Return M(q), shape (nq, nq), in kg m^2, by composite rigid bodies."""
        bodies, placements = self._constants.bodies, self._placements(q)
        masses = [body.mass for body in bodies]
        moments = [body.moment for body in bodies]
        inertias = [body.inertia for body in bodies]
        for index in reversed(range(len(bodies))):
            parent, (R, p) = bodies[index].parent, placements[index]
            if parent is None:
                continue
            moment = product(R, moments[index])
            about_parent = shift_inertia(rotate_tensor(R, inertias[index]), moment, masses[index], p)
            inertias[parent] = [add(a, b) for a, b in zip(inertias[parent], about_parent, strict=True)]
            moments[parent] = add(moments[parent], moment, scale(masses[index], p))
            masses[parent] = plus(masses[parent], masses[index])
        M: list[list[Scalar]] = [[0.0] * len(bodies) for _ in bodies]
        for index, body in enumerate(bodies):
            # Force and moment, about the body's origin, for unit acceleration of its joint.
            force = scale(masses[index], _Z) if body.prismatic else cross(_Z, moments[index])
            moment = cross(moments[index], _Z) if body.prismatic else [row[2] for row in inertias[index]]
            at, parent = index, body.parent
            M[index][index] = plus(force[2] if body.prismatic else moment[2], body.armature)
            while parent is not None:
                R, p = placements[at]
                force = product(R, force)
                moment = add(product(R, moment), cross(p, force))
                at, parent = parent, bodies[parent].parent
                M[index][at] = M[at][index] = force[2] if bodies[at].prismatic else moment[2]
        return M

    def _placements(self, q: Vector) -> list[tuple[Matrix, Vector]]:
        """Return each body's rotation and origin in its parent's frame."""
        if self._placed is None or self._placed[0] is not q:
            pairs = zip(self._constants.bodies, q, strict=True)
            self._placed = q, [self._placement(body, position) for body, position in pairs]
        return self._placed[1]

    def _placement(self, body: Body, position: Scalar) -> tuple[Matrix, Vector]:
        R, p = body.rotation, body.position
        if body.prismatic:
            return R, add(p, [times(row[2], position) for row in R])
        s, c = self._sine_cosine(position)
        turning = [
            [plus(times(row[0], c), times(row[1], s)), minus(times(row[1], c), times(row[0], s)), row[2]] for row in R
        ]
        return turning, p

    def _motions(
        self, placements: list[tuple[Matrix, Vector]], dq: Vector, ddq: Vector, acceleration: Vector
    ) -> list[Moved]:
        """Return the motion of each body from joint velocities and accelerations, and the base's acceleration."""
        motions: list[Moved] = []
        for body, (R, p), speed, change in zip(self._constants.bodies, placements, dq, ddq, strict=True):
            base = Moved(_ZERO, _ZERO, acceleration) if body.parent is None else motions[body.parent]
            back = transpose(R)
            carried = add(base.acceleration, cross(base.turning, p), cross(base.spin, cross(base.spin, p)))
            spin, turning, a = product(back, base.spin), product(back, base.turning), product(back, carried)
            across = [times(spin[1], speed), scale(-1.0, [times(spin[0], speed)])[0], 0.0]  # spin x z, times the speed
            if body.prismatic:
                a = add(a, scale(2.0, across), [0.0, 0.0, change])
            else:
                spin, turning = add(spin, [0.0, 0.0, speed]), add(turning, across, [0.0, 0.0, change])
            motions.append(Moved(spin, turning, a))
        return motions


class Factors:
    """Factors A = L D L^T of a symmetric matrix, without pivoting.

    Args:
        A: Matrix, shape (n, n); only its upper triangle is read.

    Attributes:
        pivots: D, shape (n,); A is positive definite if all are above 0.
    """

    def __init__(self, A: Matrix) -> None:
        n = len(A)
        self._L: list[list[Scalar]] = [[0.0] * n for _ in range(n)]
        self._inverses: list[Scalar] = []
        self.pivots: list[Scalar] = []
        for j in range(n):
            scaled = [times(self._L[j][k], self.pivots[k]) for k in range(j)]
            self.pivots.append(minus(A[j][j], dot(self._L[j][:j], scaled)))
            self._inverses.append(1.0 / self.pivots[j])
            for i in range(j + 1, n):
                self._L[i][j] = times(minus(A[j][i], dot(self._L[i][:j], scaled)), self._inverses[j])

    def solve(self, b: Vector) -> Vector:
        """Return A^-1 b, shape (n,)."""
        L, n = self._L, len(b)
        y: list[Scalar] = []
        for i in range(n):
            y.append(minus(b[i], dot(L[i][:i], y)))
        x = [times(y[i], self._inverses[i]) for i in range(n)]
        for i in reversed(range(n)):
            x[i] = minus(x[i], dot([L[k][i] for k in range(i + 1, n)], x[i + 1 :]))
        return x

    def inverse(self) -> Matrix:
        """Return A^-1, shape (n, n)."""
        n = len(self.pivots)
        return [self.solve([1.0 if i == j else 0.0 for i in range(n)]) for j in range(n)]


class PointScalars(NamedTuple):
    """Constants of an end point.

    Attributes:
        arm: The arm that ends at the point.
        first: Index of the arm's first joint.
        rotation: Rotation of the arm's base, shape (3, 3), if the base is at the previous end point and does not
            rotate; else None.
    """

    arm: ArmConstants
    first: int
    rotation: Matrix | None


def point_scalars(robot: Robot, ignore_base_rotation: bool, number: Callable[[float], Any]) -> tuple[PointScalars, ...]:
    """Return the constants of all stages' end points as scalars."""
    riding, still = robot.stages[1:], [0.0] * 3
    if not (riding and ignore_base_rotation):
        frames = [*(str(stage.base_frame) for stage in riding), None]
        return tuple(PointScalars(constants_of(robot.model, number, still, frame), 0, None) for frame in frames)
    found = [PointScalars(constants_of(robot.model, number, still, str(riding[0].base_frame)), 0, None)]
    for index, stage in enumerate(riding, start=1):
        rotation = StageBase(robot, index, ignore_base_rotation=True).rotation.tolist()
        turned = [[number(value) for value in row] for row in rotation]
        found.append(PointScalars(constants_of(stage.model, number, still), stage.joints.start, turned))
    return tuple(found)


def expressed_points(points: tuple[PointScalars, ...], q: Vector) -> list[Value]:
    """Return the end points in the robot's base frame from the joint positions, three numbers for each stage."""
    found: list[Vector] = []
    for point in points:
        own = q[point.first : point.first + len(point.arm.bodies)]
        x = ArmAlgebra(point.arm).tip(own, [0.0] * len(own))[0]
        found.append(x if point.rotation is None else add(found[-1], product(point.rotation, x)))
    return [value for point in found for value in point]
