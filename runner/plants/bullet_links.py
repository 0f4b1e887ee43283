"""Links of an arm as PyBullet's reader of URDFs makes them, with its operations, without PyBullet."""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence

from runner.robots.elements import TENSOR, end_of, numbers
from runner.robots.inertials import turn_to_principal_axes
from runner.symbolic.bullet_step import (
    BulletArm,
    BulletLink,
    Quaternion,
    quaternion_product,
    rotate,
    rotation_matrix,
)
from runner.symbolic.vectors import Matrix, Vector, add, cross, dot, matrix_product, product, scale, transpose

_IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
_TYPES = ("revolute", "continuous", "prismatic", "fixed")

Frame = tuple[Matrix, Vector]
"""Rotation and origin of a frame in another one."""


def bullet_text(urdf: str) -> str:
    """Return the text that PyBullet reads: inertial frames along principal axes, as Bullet turns them only to 1e-8.

    The base keeps the axes of its link, because it does not move: Bullet rounds a turned base again in each step.
    """
    root = ET.fromstring(urdf)  # noqa: S314 - text from the runner, checked when it was read
    base = _base_of(root)
    for link in root.findall("link"):
        if link.get("name") != base:
            turn_to_principal_axes(link)
        elif (origin := link.find("inertial/origin")) is not None:
            origin.attrib.pop("rpy", None)
    ET.indent(root)  # Bullet breaks names and numbers in long lines
    return ET.tostring(root, encoding="unicode")


def _base_of(root: ET.Element) -> str:
    """Return the name of the link that no joint moves; empty for a robot without links."""
    moved = {end_of(joint, "child") for joint in root.findall("joint")}
    return next((name for link in root.findall("link") if (name := link.get("name", "")) not in moved), "")


def read_arm(urdf: str, joints: Sequence[str]) -> BulletArm | None:
    """Return an arm as Bullet 3.27 has it (URDF2Bullet.cpp, UrdfParser.cpp); None if its step is not known.

    Args:
        urdf: Canonical text of the arm.
        joints: Names of the moving joints, in the order of their positions.
    """
    root = ET.fromstring(bullet_text(urdf))  # noqa: S314 - text from the runner, checked when it was read
    elements = {link.get("name", ""): link for link in root.findall("link")}
    below: dict[str, list[ET.Element]] = {}
    for joint in root.findall("joint"):
        below.setdefault(end_of(joint, "parent"), []).append(joint)
    order = list(_outwards(_base_of(root), below))
    inertials = {name: _inertial(link) for name, link in elements.items()}
    if any(joint.get("type") not in _TYPES or inertials[end_of(joint, "child")] is None for joint in order):
        return None
    numbered = {end_of(joint, "child"): number for number, joint in enumerate(order)}
    links = [_link(joint, inertials, numbered, joints) for joint in order]
    limits = [
        (joints.index(joint.get("name", "")), *range_) for joint in order if (range_ := _limits(joint)) is not None
    ]
    return BulletArm(links, limits)


def _outwards(link: str, below: Mapping[str, Sequence[ET.Element]]) -> Iterator[ET.Element]:
    """Yield the joints in Bullet's order: each before those that it carries, siblings in the order of the text."""
    for joint in below.get(link, ()):
        yield joint
        yield from _outwards(end_of(joint, "child"), below)


_Inertial = tuple[float, Vector, Frame]


def _link(
    joint: ET.Element, inertials: Mapping[str, _Inertial | None], numbered: Mapping[str, int], joints: Sequence[str]
) -> BulletLink:
    parent, child, kind = end_of(joint, "parent"), end_of(joint, "child"), joint.get("type")
    mass, inertia, frame = inertials[child] or (0.0, [0.0] * 3, (_IDENTITY, [0.0] * 3))
    own_parent = inertials[parent]
    above = _inverse((_IDENTITY, [0.0] * 3) if own_parent is None else own_parent[2])
    at = _frame(joint.find("origin"))
    place = matrix_product(above[0], at[0]), add(product(above[0], at[1]), above[1])
    to_centre = _inverse(frame)
    own = _quaternion(to_centre[0])
    turn = quaternion_product(own, _quaternion(transpose(place[0])))
    pivot, offset = place[1], scale(-1.0, to_centre[1])
    axis = rotate(own, _numbers(joint.find("axis"), "xyz") or [1.0, 0.0, 0.0])
    index = None if kind == "fixed" else joints.index(joint.get("name", ""))
    if kind in ("revolute", "continuous"):
        moves = axis, cross(axis, offset)
        length = math.sqrt(dot(axis, axis))
        return BulletLink(numbered.get(parent), index, mass, inertia, *moves, turn, None, length, pivot, offset)
    moves = [0.0] * 3, axis if kind == "prismatic" else [0.0] * 3
    offset = add(offset, rotate(turn, pivot))
    rotation = rotation_matrix(turn)
    return BulletLink(numbered.get(parent), index, mass, inertia, *moves, None, rotation, 1.0, [0.0] * 3, offset)


def _inertial(link: ET.Element) -> _Inertial | None:
    """Return mass, principal moments and frame; None if Bullet would take other values than those of the text."""
    inertial = link.find("inertial")
    if inertial is None:
        return None
    mass = _number(inertial.find("mass"), "value")
    moments = [_number(inertial.find("inertia"), key) for key in TENSOR]
    x, y, z = inertia = [moments[0], moments[3], moments[5]]
    possible = min(inertia) >= 0.0 and x <= y + z and y <= x + z and z <= x + y
    return (mass, inertia, _frame(inertial.find("origin"))) if possible else None


def _limits(joint: ET.Element) -> tuple[float, float] | None:
    """Return the limits at which Bullet stops a joint; None without limits."""
    limit = joint.find("limit")
    if joint.get("type") not in ("revolute", "prismatic") or limit is None:
        return None
    lower, upper = _number(limit, "lower"), _number(limit, "upper", -1.0)
    return (lower, upper) if lower <= upper else None


def _frame(origin: ET.Element | None) -> Frame:
    """Return the frame of an `<origin>`."""
    angles = _numbers(origin, "rpy")
    rotation = _IDENTITY
    if angles:
        (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle / 2.0), math.cos(angle / 2.0)) for angle in angles)
        turn = [
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        ]
        inverse = 1.0 / math.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3])
        rotation = rotation_matrix([part * inverse for part in turn])
    return rotation, _numbers(origin, "xyz") or [0.0] * 3


def _inverse(frame: Frame) -> Frame:
    back = transpose(frame[0])
    return back, product(back, scale(-1.0, frame[1]))


def _quaternion(R: Matrix) -> Quaternion:
    """Return the quaternion of a rotation matrix, shape (3, 3)."""
    trace = R[0][0] + R[1][1] + R[2][2]
    found = [0.0] * 4
    if trace > 0.0:
        s = math.sqrt(trace + 1.0)
        found[3], s = s * 0.5, 0.5 / s
        found[:3] = [(R[2][1] - R[1][2]) * s, (R[0][2] - R[2][0]) * s, (R[1][0] - R[0][1]) * s]
        return found
    i = (2 if R[1][1] < R[2][2] else 1) if R[0][0] < R[1][1] else (2 if R[0][0] < R[2][2] else 0)
    j, k = (i + 1) % 3, (i + 2) % 3
    s = math.sqrt(R[i][i] - R[j][j] - R[k][k] + 1.0)
    found[i], s = s * 0.5, 0.5 / s
    found[3], found[j], found[k] = (R[k][j] - R[j][k]) * s, (R[j][i] + R[i][j]) * s, (R[k][i] + R[i][k]) * s
    return found


def _numbers(element: ET.Element | None, key: str) -> list[float]:
    return [] if element is None else numbers(element.get(key, ""))


def _number(element: ET.Element | None, key: str, missing: float = 0.0) -> float:
    found = _numbers(element, key)
    return found[0] if found else missing
