"""Checks of an arm's joints: types and limits."""

import math
import xml.etree.ElementTree as ET
from collections.abc import Collection

from runner.doctor.finding import Finding
from runner.robots.joint_dynamics import hold
from runner.robots.tree import UrdfTree, moves, number

_NO_LIMIT = "1e6"  # what the runner takes for none


def check_joints(tree: UrdfTree, tip: str) -> list[Finding]:
    """Return the problems of the joints of an arm, and fix in place what leaves no choice.

    Joints that move and do not lie between base and tip are held: the runner takes serial arms.
    """
    way, findings = tree.way(tip), []
    for name, joint in tree.joints.items():
        if moves(joint):
            findings += _check_joint(tree, name) if name in way else [_hold(tree, name, way)]
    return findings


def _hold(tree: UrdfTree, name: str, way: Collection[str]) -> Finding:
    joint, tie = tree.joints[name], tree.ties.get(name)
    mimic, unit = joint.find("mimic"), "m" if joint.get("type") == "prismatic" else "rad"
    text = "moves, but not the tip" + (f", and {tie}" if tie else "")
    if mimic is not None and mimic.get("joint") in way:
        text += ", which moves the tip: its links no longer move with that"
    held = hold(tree, name)
    where = ", as the keyframe 'home' has it" if name in tree.home else ", its limit nearest to zero" if held else ""
    return Finding("fixed", f"joint '{name}'", text, f"now held at {held:.6g} {unit}{where}")


def _check_joint(tree: UrdfTree, name: str) -> list[Finding]:
    joint, place, findings = tree.joints[name], f"joint '{name}'", []
    kind = joint.get("type", "")
    if kind not in ("revolute", "continuous", "prismatic"):
        return [Finding("refused", place, f"it is {kind or 'of no type'}", "allowed: revolute, prismatic or fixed")]
    if name in tree.ties:
        text = f"it moves the tip and {tree.ties[name]}, and engines would let it move freely"
        return [Finding("refused", place, text, "take that out, make it fixed, or choose another --tip")]
    limit = joint.find("limit")
    if limit is None:
        limit = ET.SubElement(joint, "limit")
    if kind == "continuous":
        joint.set("type", "revolute")
        limit.attrib.update(lower=f"-{_NO_LIMIT}", upper=_NO_LIMIT)
        findings.append(Finding("fixed", place, "continuous", f"now revolute up to {_NO_LIMIT} rad: without limits"))
    findings += _check_positions(place, joint, limit)
    return findings + [finding for key in ("effort", "velocity") for finding in _check_limit(place, limit, key)]


def _check_positions(place: str, joint: ET.Element, limit: ET.Element) -> list[Finding]:
    lower, upper = number(limit, "lower"), number(limit, "upper")
    if lower < upper:
        return []
    said = "no position limits" if math.isnan(lower) or math.isnan(upper) else f"limits from {lower:g} to {upper:g}"
    if joint.get("type") == "prismatic":
        return [Finding("refused", place, f"it slides, with {said}", "give lower and upper, in m")]
    limit.attrib.update(lower=f"-{_NO_LIMIT}", upper=_NO_LIMIT)
    return [Finding("fixed", place, said, f"now {_NO_LIMIT} rad to both sides: without limits")]


def _check_limit(place: str, limit: ET.Element, key: str) -> list[Finding]:
    value = number(limit, key)
    if value > 0.0:
        return []
    limit.set(key, _NO_LIMIT)
    if math.isnan(value):
        return [Finding("note", place, f"no {key} limit", "give that of the data sheet, if it matters")]
    return [
        Finding("fixed", place, f"{key} limit {value:g}, at which nothing moves", f"now {_NO_LIMIT}: without limit")
    ]
