"""Elements of a URDF: values of their attributes, new joints, and checks of places, inertials and limits."""

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator

from runner.base.sanitize import quoted
from runner.schema.model import LARGEST, SMALLEST

NO_LIMIT = 1e6
"""Smallest absolute value, in SI units, that means no limit, because URDF requires limits of joints."""
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?inf(inity)?|nan", re.IGNORECASE | re.ASCII)
_NONE = f"{NO_LIMIT:.0f}"
TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def end_of(joint: ET.Element, role: str) -> str:
    """Return the name of the link at an end of a joint; role is "parent" or "child"."""
    element = joint.find(role)
    return "" if element is None else element.get("link", "")


def moves(joint: ET.Element) -> bool:
    """Return True if the type of a joint is not fixed."""
    return joint.get("type") != "fixed"


def numbers(text: str) -> list[float]:
    """Return the numbers in the value of an attribute; empty if one of its words is not a decimal number."""
    words = text.split()
    return [float(word) for word in words] if all(map(_NUMBER.fullmatch, words)) else []


def number(element: ET.Element | None, key: str) -> float:
    """Return the number in an attribute of an element, or NaN if it is missing or not a number."""
    found = [] if element is None else numbers(element.get(key, ""))
    return found[0] if len(found) == 1 else math.nan


def vector_text(values: Iterable[float]) -> str:
    """Return numbers as the value of an XML attribute."""
    return " ".join(repr(float(value)) for value in values)


def add_joint(robot: ET.Element, name: str, kind: str, parent: str, child: str, **origin: str) -> ET.Element:
    """Add a joint between two links to a URDF; `origin` has the attributes of its origin."""
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    ET.SubElement(joint, "origin", origin)
    return joint


def limit_of(joint: ET.Element, key: str) -> float:
    """Return a limit of a moving joint, in SI units: infinite if it means no limit, 0 if it is missing."""
    value = number(joint.find("limit"), key)
    return 0.0 if math.isnan(value) else value if abs(value) < NO_LIMIT else math.copysign(math.inf, value)


def wrong_places(element: ET.Element) -> Iterator[tuple[str, str]]:
    """Yield messages about invalid positions, rotations and axes of a link or joint, each with a remedy."""
    for part in element.iter():
        for key in ("xyz", "rpy") if part.tag in ("origin", "axis") else ():
            words = part.get(key)
            if words is not None and not _is_vector(words):
                yield (
                    f"<{part.tag} {key}={quoted(words)}>",
                    f"allowed: three numbers, parted by spaces, up to {LARGEST:g}",
                )
            elif part.tag == "axis" and moves(element) and words and not any(numbers(words)):
                yield "an axis of length 0", "give it a direction"
        if part.tag == "origin" and part.get("quat_xyzw") is not None:  # otherwise it is rpy by now
            yield (
                f"<origin quat_xyzw={quoted(part.get('quat_xyzw'))}>",
                "allowed: four numbers, not all zero, and no rpy with them",
            )


def absurd_inertial(link: ET.Element) -> Iterator[str]:
    """Yield messages about absurd masses and inertias of a link; values that are not numbers are checked elsewhere."""
    mass = number(link.find("inertial/mass"), "value")
    if LARGEST < mass < math.inf or 0.0 < mass < SMALLEST:
        yield f"mass {mass:g} kg; allowed: 0, or {SMALLEST:g} to {LARGEST:g}"
    for key in TENSOR:
        moment = number(link.find("inertial/inertia"), key)
        if LARGEST < abs(moment) < math.inf:
            yield f"inertia {key} of {moment:g} kg m^2; allowed: up to {LARGEST:g}"


def wrong_limits(joint: ET.Element) -> Iterator[str]:
    """Yield messages about missing and invalid limits of a revolute or prismatic joint."""
    if joint.get("type") not in ("revolute", "prismatic"):
        return
    limit = joint.find("limit")
    if limit is None:
        yield f"no <limit>; give it lower, upper, effort and velocity, {_NONE} for none"
        return
    if limit.get("lower") is None and limit.get("upper") is None:
        yield f"no position limits; give lower and upper, -{_NONE} and {_NONE} for none"
    for key in ("effort", "velocity"):
        if limit.get(key) is None:
            yield f"no {key} limit; give it, {_NONE} for none"
    for key in ("lower", "upper", "effort", "velocity"):
        if limit.get(key) is not None and math.isnan(number(limit, key)):
            yield f"a limit {key}={quoted(limit.get(key))}; allowed: a number"
    lower, upper = number(limit, "lower"), number(limit, "upper")
    if lower > upper:
        yield f"limits from {lower:g} to {upper:g}; lower must be below upper"
    for key in ("effort", "velocity"):
        if number(limit, key) < 0.0:
            yield f"{key} limit {number(limit, key):g}; allowed: 0 or more"


def wrong_friction(joint: ET.Element) -> Iterator[str]:
    """Yield a message about a negative friction of a moving joint, which Pinocchio does not read."""
    value = number(joint.find("dynamics"), "friction")
    if moves(joint) and value < 0.0:
        yield f"<dynamics friction={quoted(f'{value:g}')}>; allowed: 0 or more"


def wrong_mass(link: ET.Element) -> Iterator[str]:
    """Yield a message about a mass that is negative or not a finite number."""
    element = link.find("inertial/mass")
    text, mass = None if element is None else element.get("value"), number(element, "value")
    if element is None or 0.0 <= mass < math.inf:
        return
    if text is None:
        yield "a <mass> without value; write it, in kg"
    elif math.isfinite(mass):
        yield f"mass {mass:g} kg; allowed: 0 or more"
    else:
        yield f"<mass value={quoted(text)}>; allowed: a number of 0 or more, in kg"


def _is_vector(text: str) -> bool:
    values = numbers(text)
    return len(values) == 3 and all(abs(value) <= LARGEST for value in values)
