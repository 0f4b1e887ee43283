"""Numeric values of a URDF, with plausibility checks."""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator

from runner.base.sanitize import quoted
from runner.robots.tree import moves
from runner.schema.plausibility import LARGEST, SMALLEST

NO_LIMIT = 1e6
"""Size, in SI units, from which a limit says that there is none: URDF demands limits of joints."""
TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def number(element: ET.Element | None, key: str) -> float:
    """Return what an attribute of an element says, or NaN where it is missing or no number."""
    try:
        return math.nan if element is None else float(element.get(key, "nan"))
    except ValueError:
        return math.nan


def limit_of(joint: ET.Element, key: str) -> float:
    """Return a limit of a joint that moves, in SI units: infinite if the file sets none, 0 if it omits the value."""
    value = number(joint.find("limit"), key)
    return 0.0 if math.isnan(value) else value if abs(value) < NO_LIMIT else math.copysign(math.inf, value)


def wrong_places(element: ET.Element) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with the places, turns and axes of a link or joint, and what to do about it."""
    for part in element.iter():
        for key in ("xyz", "rpy") if part.tag in ("origin", "axis") else ():
            words = part.get(key)
            if words is not None and not _is_vector(words):
                yield (
                    f"<{part.tag} {key}={quoted(words)}>",
                    f"allowed: three numbers, parted by spaces, up to {LARGEST:g}",
                )
            elif part.tag == "axis" and moves(element) and words and not any(map(float, words.split())):
                yield "an axis of length 0", "give it a direction"


def absurd_inertial(link: ET.Element) -> Iterator[str]:
    """Yield masses and moments of inertia of a link that no body has; those that are no numbers are told elsewhere."""
    mass = number(link.find("inertial/mass"), "value")
    if LARGEST < mass < math.inf or 0.0 < mass < SMALLEST:
        yield f"mass {mass:g} kg; allowed: 0, or {SMALLEST:g} to {LARGEST:g}"
    for key in TENSOR:
        moment = number(link.find("inertial/inertia"), key)
        if LARGEST < abs(moment) < math.inf:
            yield f"inertia {key} of {moment:g} kg m^2; allowed: up to {LARGEST:g}"


def wrong_limits(joint: ET.Element) -> Iterator[str]:
    """Yield what is wrong with the limits of a joint that moves; those that are missing are told elsewhere."""
    limit = joint.find("limit")
    if limit is None or not moves(joint):
        return
    for key in ("lower", "upper", "effort", "velocity"):
        if limit.get(key) is not None and math.isnan(number(limit, key)):
            yield f"a limit {key}={quoted(limit.get(key))}; allowed: a number"
    lower, upper = number(limit, "lower"), number(limit, "upper")
    if lower > upper:
        yield f"limits from {lower:g} to {upper:g}; lower must be below upper"
    for key in ("effort", "velocity"):
        if number(limit, key) < 0.0:
            yield f"{key} limit {number(limit, key):g}; allowed: 0 or more"


def _is_vector(text: str) -> bool:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return False
    return len(values) == 3 and all(abs(value) <= LARGEST for value in values)
