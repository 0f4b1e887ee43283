"""Kinematics and dynamics from a URDF without Pinocchio: frames, mass matrix, gravity, Christoffel symbols."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import derivative, rotation, turn
from runner.robots.elements import end_of


@dataclass(frozen=True)
class _Joint:
    """A joint; `place` is its number among those that move, None where it is fixed."""

    name: str
    parent: str
    child: str
    origin: FloatArray
    axis: FloatArray
    prismatic: bool
    armature: float
    place: int | None


@dataclass(frozen=True)
class _Body:
    """A link's mass and tensor about its centre of mass, and that centre in the link's frame."""

    link: str
    mass: float
    centre: FloatArray
    tensor: FloatArray


class UrdfChain:
    """The links of a URDF, at many configurations at once.

    Args:
        urdf: The URDF's text.
        joints: Names of the joints that move, in the order of the joint positions.
        gravity: Gravity in the base frame, shape (3,), in m/s^2.
    """

    def __init__(self, urdf: str, joints: Sequence[str], gravity: FloatArray) -> None:
        robot = ET.fromstring(urdf)  # noqa: S314 - a text that the runner has made, or Pinocchio has read
        found = [_joint(element, joints) for element in robot.findall("joint")]
        borne = {joint.child for joint in found}
        (self._root,) = {name for link in robot.findall("link") if (name := link.get("name", "")) not in borne}
        self._joints: list[_Joint] = []  # each after its parent
        reached = [self._root]
        for link in reached:
            hanging = [joint for joint in found if joint.parent == link]
            self._joints += hanging
            reached += [joint.child for joint in hanging]
        bodies = map(_body, robot.findall("link"))
        self._bodies = [body for body in bodies if body.mass or body.tensor.any()]
        self._gravity = gravity

    def frames(self, q: FloatArray) -> dict[str, FloatArray]:
        """Return the transforms of all links, and of joints by their names, in the base frame, shape (T, 4, 4)."""
        found = {self._root: np.tile(np.eye(4), (len(q), 1, 1))}
        for joint in self._joints:
            placed = found[joint.parent] @ joint.origin
            found[joint.name] = found[joint.child] = placed if joint.place is None else placed @ _motion(joint, q)
        return found

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Return twice the kinetic energy as a matrix between joint velocities, shape (T, n, n)."""
        motors = np.zeros(q.shape[1])
        for joint in self._joints:
            if joint.place is not None:
                motors[joint.place] = joint.armature
        frames, total = self.frames(q), np.tile(np.diag(motors), (len(q), 1, 1))
        for body in self._bodies:
            centre = frames[body.link] @ body.centre
            J = np.zeros((len(q), 6, q.shape[1]))  # velocity of the centre and turning, by joint
            for joint in self._moving(body.link):
                frame = frames[joint.child]
                axis = frame[:, :3, :3] @ joint.axis
                lever = np.cross(axis, centre[:, :3, 3] - frame[:, :3, 3])
                J[:, :, joint.place] = np.hstack([axis, 0.0 * axis] if joint.prismatic else [lever, axis])
            turned = centre[:, :3, :3].transpose(0, 2, 1) @ J[:, 3:]  # along the axes of the tensor
            total += (
                body.mass * J[:, :3].transpose(0, 2, 1) @ J[:, :3] + turned.transpose(0, 2, 1) @ body.tensor @ turned
            )
        return total

    def gravity_torque(self, q: FloatArray) -> FloatArray:
        """Return the derivatives of the potential energy by differences, shape (T, n)."""

        def energy(at: FloatArray) -> FloatArray:
            frames, total = self.frames(at), np.zeros(len(at))
            for body in self._bodies:
                total -= body.mass * (frames[body.link] @ body.centre)[:, :3, 3] @ self._gravity
            return total

        return np.column_stack([derivative(energy, q, joint) for joint in range(q.shape[1])])

    def christoffel(self, q: FloatArray) -> FloatArray:
        """Return b_ijk, V_i the sum of b_ijk dq_j dq_k, from differences of the mass matrix, shape (T, n, n, n)."""
        m = np.stack([derivative(self.mass_matrix, q, k) for k in range(q.shape[1])], axis=3)  # dM_ij / dq_k
        return np.asarray((m + m.transpose(0, 1, 3, 2) - m.transpose(0, 3, 1, 2)) / 2)

    def _moving(self, link: str) -> Iterator[_Joint]:
        """Yield the joints that move a link."""
        for joint in reversed(self._joints):
            if joint.child == link:
                link = joint.parent
                if joint.place is not None:
                    yield joint


def _joint(element: ET.Element, names: Sequence[str]) -> _Joint:
    axis, name = _vector(element.find("axis"), "xyz", "1 0 0"), element.get("name", "")
    return _Joint(
        name,
        end_of(element, "parent"),
        end_of(element, "child"),
        _origin(element.find("origin")),
        axis / np.linalg.norm(axis),
        element.get("type") == "prismatic",
        0.0 if (dynamics := element.find("dynamics")) is None else float(dynamics.get("armature", "0")),
        names.index(name) if name in names else None,
    )


def _motion(joint: _Joint, q: FloatArray) -> FloatArray:
    """Return the transforms of a joint at its positions, shape (T, 4, 4)."""
    by = q[:, joint.place]
    if not joint.prismatic:
        return turn(joint.axis, by)
    moved = np.tile(np.eye(4), (len(q), 1, 1))
    moved[:, :3, 3] = np.outer(by, joint.axis)
    return moved


def _origin(element: ET.Element | None) -> FloatArray:
    roll, pitch, yaw = _vector(element, "rpy", "0 0 0")
    result: FloatArray = (rotation("z", yaw) @ rotation("y", pitch) @ rotation("x", roll))[0]
    result[:3, 3] = _vector(element, "xyz", "0 0 0")
    return result


def _vector(element: ET.Element | None, key: str, missing: str) -> FloatArray:
    return np.array([float(word) for word in (missing if element is None else element.get(key, missing)).split()])


def _body(link: ET.Element) -> _Body:
    def number(tag: str, key: str) -> float:
        element = link.find(f"inertial/{tag}")
        return 0.0 if element is None else float(element.get(key, "0"))

    xx, xy, xz, yy, yz, zz = (number("inertia", f"i{key}") for key in ("xx", "xy", "xz", "yy", "yz", "zz"))
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return _Body(link.get("name", ""), number("mass", "value"), _origin(link.find("inertial/origin")), tensor)
