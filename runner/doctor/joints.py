"""The joints of an arm: their kinds and their limits."""

import math
import xml.etree.ElementTree as ET
from collections.abc import Collection

from runner.doctor.finding import Finding
from runner.robots.joint_dynamics import hold
from runner.robots.tree import UrdfTree, moves
from runner.robots.urdf_values import number

_NO_LIMIT = "1e6"  # what the runner takes for none


def check_joints(tree: UrdfTree, tip: str) -> list[Finding]:
    """Return what is wrong with the joints of an arm, and mend in place what can be without a choice.

    Joints that move and do not lie between base and tip are fixed: the runner takes serial arms.
    """
    way = tree.way(tip)
    fixed = sum(not moves(joint) for joint in tree.joints.values())
    beside = [name for name, joint in tree.joints.items() if moves(joint) and name not in way]
    findings = [_fix(tree, name, way) for name in beside]
    for name in way:
        if moves(tree.joints[name]):
            findings += _check_joint(name, tree.joints[name], tree.ties.get(name))
    if fixed:
        findings.append(Finding("note", "fixed joints", f"{fixed}: each rides on the link before it"))
    return findings


def _fix(tree: UrdfTree, name: str, way: Collection[str]) -> Finding:
    joint, tie = tree.joints[name], tree.ties.get(name)
    mimic, unit = joint.find("mimic"), "m" if joint.get("type") == "prismatic" else "rad"
    text = "it moves beside the way to the tip" + (f", and {tie}" if tie else "")
    if mimic is not None and mimic.get("joint") in way:
        text += ", which moves the tip: its links no longer move with that"
    held = hold(tree, name)
    where = ", as the keyframe 'home' has it" if name in tree.home else ", its limit nearest to zero" if held else ""
    return Finding("finding", f"joint '{name}'", text, f"hold it fixed at {held:.6g} {unit}{where}", True)


def _check_joint(name: str, joint: ET.Element, tie: str | None) -> list[Finding]:
    place, kind = f"joint '{name}'", joint.get("type", "")
    findings = []
    if kind not in ("revolute", "continuous", "prismatic"):
        return [Finding("refused", place, f"it is {kind or 'of no type'}", "allowed: revolute, prismatic or fixed")]
    if tie:
        return [
            Finding("refused", place, f"it {tie}, and engines would let it move freely", "take that out, or fix it")
        ]
    limit = joint.find("limit")
    if limit is None:
        limit = ET.SubElement(joint, "limit")
    if kind == "continuous":
        joint.set("type", "revolute")
        limit.attrib.update(lower=f"-{_NO_LIMIT}", upper=_NO_LIMIT)
        text = "continuous: Pinocchio gives it two coordinates (nq = nv + 1), PyBullet one"
        findings.append(Finding("finding", place, text, "make it revolute with wide limits", True))
    findings += _check_positions(place, joint, limit)
    findings += [finding for key in ("effort", "velocity") for finding in _check_limit(place, limit, key, joint)]
    return findings


def _check_positions(place: str, joint: ET.Element, limit: ET.Element) -> list[Finding]:
    lower, upper = number(limit, "lower"), number(limit, "upper")
    if lower < upper:
        return []
    said = "no position limits" if math.isnan(lower) or math.isnan(upper) else f"limits from {lower:g} to {upper:g}"
    if joint.get("type") == "prismatic":
        return [Finding("refused", place, f"it slides, with {said}", "give lower and upper, in m")]
    limit.attrib.update(lower=f"-{_NO_LIMIT}", upper=_NO_LIMIT)
    return [Finding("finding", place, said, "give lower and upper, in rad; wide ones where there are none", True)]


def _check_limit(place: str, limit: ET.Element, key: str, joint: ET.Element) -> list[Finding]:
    value = number(limit, key)
    if value > 0.0:
        return []
    limit.set(key, _NO_LIMIT)
    slides = joint.get("type") == "prismatic"
    unit = {"effort": "N" if slides else "N m", "velocity": "m/s" if slides else "rad/s"}[key]
    said = f"no {key} limit" if math.isnan(value) else f"{key} limit {value:g}, with which it could not move"
    return [Finding("finding", place, said, f"give that of the data sheet, in {unit}; {_NO_LIMIT} for none", True)]
