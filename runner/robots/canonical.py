"""Canonical text of a robot: the one form of a URDF that every engine reads alike.

A file is read once: `canonize` rewrites its values in place. A text is written once: `write_text` keeps the elements
that runs need.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from runner.base.lazy_modules import pin
from runner.robots.elements import NO_LIMIT, TENSOR, moves, number, numbers, vector_text
from runner.schema.model import LARGEST, SMALLEST

# Parts of each element, and the numbers in its attributes.
_PARTS: Mapping[str, Sequence[str]] = {
    "robot": ("link", "joint", "left_out"),
    "link": ("inertial", "visual", "collision"),
    "inertial": ("origin", "mass", "inertia"),
    "visual": ("origin", "geometry"),
    "collision": ("origin", "geometry"),
    "geometry": ("box", "capsule", "cylinder", "sphere"),
    "joint": ("parent", "child", "origin", "axis", "limit", "dynamics"),
}
_NUMBERS: Mapping[str, Sequence[str]] = {
    "origin": ("xyz", "rpy"),
    "mass": ("value",),
    "inertia": TENSOR,
    "box": ("size",),
    "capsule": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "sphere": ("radius",),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "effort", "velocity"),
    "dynamics": ("damping", "friction", "armature"),
}
_NAMES: Mapping[str, Sequence[str]] = {
    "robot": ("name",),
    "link": ("name",),
    "joint": ("name", "type"),
    "parent": ("link",),
    "child": ("link",),
    "left_out": ("text", "gravity"),
}
_SEVERAL = {"link", "joint", "left_out", "visual", "collision"}  # of other elements, readers take the first
_OF_FIXED = ("parent", "child", "origin")
_UNIT = 1e-15  # of a unit vector's length: it does not change
_TOLD = 1e-9  # of an axis' length: smaller differences are rounding of the file


class Change(NamedTuple):
    """Change of an element that a reader of the file should know.

    Attributes:
        place: The link or joint, as in "joint 'q1'".
        text: The element in the file.
        now: The element in the canonical text.
    """

    place: str
    text: str
    now: str


def canonize(links: Mapping[str, ET.Element], joints: Mapping[str, ET.Element]) -> tuple[Change, ...]:
    """Rewrite the values of links and joints in place, so that all engines read them alike.

    Numbers are plain and keep their digits, axes have the length 1, orientations are roll, pitch and yaw, limits have
    both bounds, and what the format leaves to a default is written. Values that cannot be read stay for the checks.
    Rewriting twice changes nothing.

    Args:
        links: Links by name.
        joints: Joints by name.

    Returns:
        The changes of meaning, without those of notation.
    """
    changes: list[Change] = []
    for name, link in links.items():
        changes += (Change(f"link '{name}'", *each) for each in _rewrite_values(link))
        changes += (Change(f"link '{name}'", *each) for each in _remove_placeholder(link))
    for name, joint in joints.items():
        changes += (Change(f"joint '{name}'", *each) for each in _rewrite_values(joint))
        if moves(joint):
            said = (*_complete_axis(joint), *_complete_bounds(joint))
            changes += (Change(f"joint '{name}'", *each) for each in said)
        for dynamics in joint.findall("dynamics"):
            for key in ("damping", "friction"):  # readers require one of them, and runs read neither from the text
                if not math.isfinite(number(dynamics, key)):
                    dynamics.set(key, "0.0")
    return tuple(changes)


def _rewrite_values(whole: ET.Element) -> Iterator[tuple[str, str]]:
    """Rewrite the numbers and orientations in an element and its parts."""
    for part in whole.iter():
        if part.tag == "origin":
            yield from _turn_quaternion(part)
        for key in _NUMBERS.get(part.tag, ()):
            values = numbers(part.get(key, ""))
            if part.tag == "limit" and any(map(math.isinf, values)):
                part.set(key, vector_text(math.copysign(NO_LIMIT, value) for value in values))
                yield f"{key} limit of {values[0]:g}", "now 1e6 in size: without limit"
            elif values and all(abs(value) <= LARGEST for value in values):
                part.set(key, vector_text(values))


def _turn_quaternion(origin: ET.Element) -> Iterator[tuple[str, str]]:
    """Write the orientation of an origin as roll, pitch and yaw; URDF 1.1 also allows a quaternion."""
    quaternion = np.array(numbers(origin.get("quat_xyzw", "")))
    if quaternion.shape != (4,) or origin.get("rpy") is not None:
        return
    length = math.hypot(*quaternion)
    if not 0.0 < length < math.inf:
        return
    rotation = pin.Quaternion(quaternion / length).toRotationMatrix()
    origin.set("rpy", vector_text(pin.rpy.matrixToRpy(rotation)))
    text = origin.attrib.pop("quat_xyzw")
    yield f"origin by quaternion {' '.join(text.split())}", f"now rpy {_short(numbers(origin.get('rpy', '')))}"


def _remove_placeholder(link: ET.Element) -> Iterator[tuple[str, str]]:
    """Take the mass of a link that is a frame, and has a mass only because a reader demands one."""
    mass, inertia = link.find("inertial/mass"), link.find("inertial/inertia")
    moments = [abs(number(inertia, key)) for key in TENSOR]
    value = number(mass, "value")
    if mass is None or inertia is None or not 0.0 < value < SMALLEST or not all(m < SMALLEST for m in moments):
        return
    mass.set("value", "0.0")
    inertia.attrib.update(dict.fromkeys(TENSOR, "0.0"))
    yield f"a mass of {value:g} kg, which is a placeholder", "now a frame without mass"


def _complete_axis(joint: ET.Element) -> Iterator[tuple[str, str]]:
    """Write the axis of a joint as a unit vector; without an axis, it is the format's x."""
    axis = joint.find("axis")
    if axis is None or axis.get("xyz") is None:
        axis = ET.SubElement(joint, "axis") if axis is None else axis
        axis.set("xyz", "1.0 0.0 0.0")
        yield "no axis", "now 1 0 0, the default of the format"
    direction = numbers(axis.get("xyz", ""))
    length = math.hypot(*direction)
    if len(direction) != 3 or not 0.0 < length < math.inf or abs(length - 1.0) < _UNIT:
        return
    axis.set("xyz", vector_text(each / length for each in direction))
    if abs(length - 1.0) > _TOLD:
        yield f"axis {_short(direction)} of length {length:.6g}", "now of length 1"


def _complete_bounds(joint: ET.Element) -> Iterator[tuple[str, str]]:
    """Write a missing position limit if the other exists; the format's default is 0."""
    limit = joint.find("limit")
    missing = [key for key in ("lower", "upper") if limit is not None and limit.get(key) is None]
    if limit is None or len(missing) != 1 or joint.get("type") not in ("revolute", "prismatic"):
        return
    limit.set(missing[0], "0.0")
    yield f"no {missing[0]} position limit", "now 0, the default of the format"


def _short(values: Iterable[float]) -> str:
    return " ".join(f"{round(value, 12) + 0.0:.4g}" for value in values)  # 0 for -0.0


def write_text(robot: ET.Element) -> str:
    """Return the canonical text of a robot: links, joints, inertials and simple shapes, one element a line.

    Meshes, whose files are not stored, shapes without a size, and elements for other programs are left out. The element
    does not change.
    """
    text = _write(robot)
    ET.indent(text)
    return ET.tostring(text, encoding="unicode")


def _write(element: ET.Element) -> ET.Element:
    tag = element.tag
    keys = (*_NAMES.get(tag, ()), *_NUMBERS.get(tag, ()))
    written = ET.Element(tag, {key: value for key in keys if (value := element.get(key)) is not None})
    kinds = _OF_FIXED if tag == "joint" and not moves(element) else _PARTS.get(tag, ())
    for kind in kinds:
        parts = element.findall(kind)
        written.extend(_write(part) for part in (parts if kind in _SEVERAL else parts[:1]) if not _is_no_shape(part))
    return written


def _is_no_shape(element: ET.Element) -> bool:
    """Return True if an element is a shape that runs do not need: a mesh, or without a size."""
    if element.tag not in ("visual", "collision"):
        return False
    solids = [solid for kind in _PARTS["geometry"] for solid in element.findall(f"geometry/{kind}")]
    sizes = [numbers(solid.get(key, "")) for solid in solids for key in _NUMBERS[solid.tag]]
    return not sizes or not all(size and min(size) > 0.0 for size in sizes)
