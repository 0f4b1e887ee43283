"""Extensions of URDF in a robot's file: xacro definitions that nothing uses, motors and springs."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping

from runner.base.sanitize import few
from runner.robots.elements import number

_XACRO = "{http://www.ros.org/wiki/xacro}"
_DEFINITIONS = {f"{_XACRO}{kind}" for kind in ("property", "arg", "macro")}
_PREFIX = re.compile(r"[<\s/]([A-Za-z_][\w.-]*):[A-Za-z_]")
_COMMENT_OR_TAG = re.compile(r"<!--.*?-->|<([A-Za-z][\w.-]*)", re.DOTALL)
_TAG = re.compile(r"<[^<>!?]*>")


def declare_prefixes(text: str) -> str:
    """Return the text of an XML file in which every prefix of a tag or attribute has a declaration.

    Drake and Gazebo read files without these declarations, which XML demands.
    """
    used = {
        prefix for tag in _TAG.findall(text) for prefix in _PREFIX.findall(re.sub(r"\"[^\"]*\"|'[^']*'", "''", tag))
    }
    missing = sorted(prefix for prefix in used - {"xml", "xmlns"} if f"xmlns:{prefix}" not in text)
    if not missing:
        return text
    names = {"xacro": _XACRO.strip("{}")}
    declared = "".join(f' xmlns:{prefix}="{names.get(prefix, prefix)}"' for prefix in missing)
    root = next((found for found in _COMMENT_OR_TAG.finditer(text) if found[1]), None)
    return text if root is None else f"{text[: root.end()]}{declared}{text[root.end() :]}"


def drop_definitions(robot: ET.Element) -> list[str]:
    """Remove xacro definitions from a robot, in place; return their names.

    Raises:
        ValueError: if the file uses xacro: it must be expanded first.
    """
    dropped = []
    for parent in list(robot.iter()):
        for element in [part for part in parent if part.tag in _DEFINITIONS]:
            dropped.append(f"'{element.get('name', '')}'")
            parent.remove(element)
    values = (value for element in robot.iter() for value in element.attrib.values())
    if any(e.tag.startswith(_XACRO) for e in robot.iter()) or any("${" in v or "$(" in v for v in values):
        raise ValueError
    return dropped


def read_motors(robot: ET.Element, joints: Mapping[str, ET.Element]) -> None:
    """Write the reflected inertia of motors into `<dynamics armature>` of their joints, in place.

    It is rotor inertia times squared gear ratio, which Drake reads from the actuator of a transmission. Reductions
    without a rotor inertia and springs become elements `<left_out>`.
    """
    reductions: dict[float, list[str]] = {}
    for name, element in _motors(robot, joints):
        rotor = _sum_of(element, "rotor_inertia", 0.0)
        gear = _sum_of(element, "gear_ratio", _sum_of(element, "mechanicalReduction", 1.0))
        if rotor > 0.0:
            dynamics = joints[name].find("dynamics")
            if dynamics is None:
                dynamics = ET.SubElement(joints[name], "dynamics")
            dynamics.attrib.setdefault("armature", repr(rotor * gear**2))
        elif abs(gear) != 1.0:
            reductions.setdefault(gear, []).append(name)
    for gear, names in reductions.items():
        text = f"reduction {gear:g} of {few(names)}, without the inertia of a rotor (robot.armature)"
        ET.SubElement(robot, "left_out", text=text, gravity="")
    with_spring = [
        each.get("reference", "")
        for each in robot.findall("gazebo")
        if each.get("reference") in joints and _sum_of(each, "springStiffness", 0.0)
    ]
    if with_spring:
        text = f"springs of the joints {few(with_spring)} (springStiffness); no key"
        ET.SubElement(robot, "left_out", text=text, gravity="")


def _motors(robot: ET.Element, joints: Mapping[str, ET.Element]) -> Iterator[tuple[str, ET.Element]]:
    """Yield each joint that has a motor, with the element that describes it: a transmission, or the joint itself."""
    for transmission in robot.findall("transmission"):
        for joint in transmission.findall("joint"):
            if joint.get("name") in joints:
                yield joint.get("name", ""), transmission
    yield from joints.items()


def _sum_of(element: ET.Element, name: str, default: float) -> float:
    """Return the sum of the values of all parts with a local name; the default if there is none."""
    found = [part for part in element.iter() if part.tag.rpartition("}")[2] == name]
    values = [number(part if part.get("value") else ET.Element(name, value=part.text or ""), "value") for part in found]
    finite = [value for value in values if abs(value) < float("inf")]
    return sum(finite) if finite else default
