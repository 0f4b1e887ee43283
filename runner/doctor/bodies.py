"""Checks of an arm's joints and links: types, limits, vectors, masses, moments of inertia and mesh files."""

import math
import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import numpy as np

from runner.base.sanitize import few, quoted
from runner.doctor.finding import DoctorFinding
from runner.robots.elements import (
    NO_LIMIT,
    TENSOR,
    absurd_inertial,
    moves,
    number,
    wrong_friction,
    wrong_mass,
    wrong_places,
)
from runner.robots.inertials import fix_inertia, impossible_inertia, make_massless, place_of, principal_moments
from runner.robots.joint_dynamics import hold, rest_position
from runner.robots.tree import UrdfTree

_NONE = repr(NO_LIMIT)
_NOT_FOUND = "not found"
_DENSEST = 2e4  # kg/m^3, of metals
_MOST_TURNS, _NO_DEGREES = 8.0 * math.pi, 1000.0  # rad: limits between them look like degrees
_DEGREES = "degrees? Multiply the limits by pi/180"
_LONGEST = 50.0  # m, of an arm
_SMALLEST_PART = 0.3  # of the lengths of all links: the least size of a link for its density


def check_joints(tree: UrdfTree, tip: str) -> list[DoctorFinding]:
    """Return the problems of the joints of an arm, and fix in place what leaves no choice.

    Joints that move and do not lie between base and tip are held: the runner takes serial arms.
    """
    way, findings = tree.way(tip), []
    moving = [name for name, joint in tree.joints.items() if moves(joint)]
    held = {name: rest_position(tree, name) for name in moving if name not in way}  # before any of them is fixed
    for name in moving:
        findings += [_hold(tree, name, held[name], way)] if name in held else _check_joint(tree, name)
    return findings


def _hold(tree: UrdfTree, name: str, held: float, way: Collection[str]) -> DoctorFinding:
    joint, tie = tree.joints[name], tree.ties.get(name)
    mimic, unit = joint.find("mimic"), "m" if joint.get("type") == "prismatic" else "rad"
    text = "moves, but not the tip" + (f", and {tie}" if tie else "")
    if mimic is not None and mimic.get("joint") in way:
        text += ", which moves the tip: its links no longer move with that"
    hold(tree, name, held)
    where = (
        ", as the keyframe 'home' has it" if name in tree.home
        else "" if not held
        else ", as it mimics" if mimic is not None
        else ", its limit nearest to zero"
    )  # fmt: skip
    return DoctorFinding("fixed", f"joint '{name}'", text, f"now held at {held:.6g} {unit}{where}")


def _check_joint(tree: UrdfTree, name: str) -> list[DoctorFinding]:
    joint, place, findings = tree.joints[name], f"joint '{name}'", []
    kind = joint.get("type", "")
    if kind not in ("revolute", "continuous", "prismatic"):
        return [
            DoctorFinding("refused", place, f"it is {kind or 'of no type'}", "allowed: revolute, prismatic or fixed")
        ]
    if name in tree.ties:
        text = f"it moves the tip and {tree.ties[name]}, and engines would let it move freely"
        return [DoctorFinding("refused", place, text, "take that out, make it fixed, or choose another --tip")]
    limit = joint.find("limit")
    if limit is None:
        limit = ET.SubElement(joint, "limit")
    if kind == "continuous":
        joint.set("type", "revolute")
        limit.attrib.update(lower=f"-{_NONE}", upper=_NONE)
        findings.append(DoctorFinding("fixed", place, "continuous", "now revolute up to 1e6 rad: without limits"))
    findings += _check_positions(tree, name, limit)
    if not moves(joint):
        return findings
    for friction in wrong_friction(joint):
        findings.append(DoctorFinding("refused", place, *friction.split("; ")))
    damping = number(joint.find("dynamics"), "damping")
    if damping < 0.0:
        findings.append(DoctorFinding("note", place, f"damping {damping:g}", "it counts as 0; allowed: 0 or more"))
    return findings + [finding for key in ("effort", "velocity") for finding in _check_limit(place, limit, key)]


def _check_positions(tree: UrdfTree, name: str, limit: ET.Element) -> list[DoctorFinding]:
    joint, place = tree.joints[name], f"joint '{name}'"
    lower, upper = number(limit, "lower"), number(limit, "upper")
    if lower < upper:
        return []
    unit = "m" if joint.get("type") == "prismatic" else "rad"
    said = f"limits from {lower:g} to {upper:g} {unit}"
    if lower > upper:
        limit.attrib.update(lower=repr(upper), upper=repr(lower))
        return [DoctorFinding("fixed", place, said, f"now exchanged: from {upper:g} to {lower:g} {unit}; check them")]
    unfilled = lower == 0.0 and not number(limit, "effort") > 0.0
    if lower == upper and not unfilled and abs(lower) < NO_LIMIT:
        hold(tree, name, lower)
        remedy = f"now a fixed joint at {lower:g} {unit}; if it moves, correct its limits"
        return [DoctorFinding("fixed", place, f"{said}, which lock it", remedy)]
    said = f"{said}, and no effort: not filled in" if unfilled else said if lower == upper else "no position limits"
    if unit == "m":
        return [DoctorFinding("refused", place, f"it slides, with {said}", "give lower and upper, in m")]
    limit.attrib.update(lower=f"-{_NONE}", upper=_NONE)
    return [DoctorFinding("fixed", place, said, "now 1e6 rad to both sides: without limits")]


def _check_limit(place: str, limit: ET.Element, key: str) -> list[DoctorFinding]:
    value = number(limit, key)
    if value > 0.0:
        return []
    if value < 0.0:
        allowed = "allowed: 0 or more, 1e6 for no limit"
        return [DoctorFinding("refused", place, f"{key} limit {value:g}", allowed)]
    limit.set(key, _NONE)
    if math.isnan(value):
        return [DoctorFinding("note", place, f"no {key} limit", "give that of the data sheet, if it matters")]
    effort = key == "effort"
    meant = "nothing drives it" if effort else "it stands still under commands of position"
    remedy = "the copy has 1e6, without limit" + ("; write 0 there for a joint without a drive" if effort else "")
    return [DoctorFinding("fixed", place, f"{key} limit 0: in a run of this file {meant}", remedy)]


def check_links(tree: UrdfTree) -> list[DoctorFinding]:
    """Return the problems of the inertials of a tree's links, and fix in place what leaves no choice."""
    return [finding for name, link in tree.links.items() for finding in _check_link(tree, name, link)]


def _check_link(tree: UrdfTree, name: str, link: ET.Element) -> list[DoctorFinding]:
    place = f"link '{name}'"
    if link.find("inertial/mass") is None:
        bare = link.find("inertial") is None
        make_massless(link)
        text = "no <inertial>: a frame without mass" if bare else "an <inertial> without <mass>"
        return [DoctorFinding("note" if bare else "fixed", place, text, "" if bare else "now without mass")]
    findings = _complete(place, link)
    mass = number(link.find("inertial/mass"), "value")
    moments = [number(link.find("inertial/inertia"), key) for key in TENSOR]
    for fault in wrong_mass(link):
        text, _, remedy = fault.partition("; ")
        return [DoctorFinding("refused", place, text, remedy)]
    if not all(map(math.isfinite, moments)):
        return [
            DoctorFinding(
                "refused", place, "an inertia that is not a finite number", "write all six moments, in kg m^2"
            )
        ]
    absurd = [DoctorFinding("refused", place, text) for text in absurd_inertial(link)]
    if absurd:
        return absurd
    wrong = impossible_inertia(link)
    if wrong:
        fix_inertia(link)
        now = ", ".join(f"{moment:.3g}" for moment in principal_moments(link))
        findings.append(DoctorFinding("fixed", place, wrong[0], f"now {now} kg m^2, the nearest that a body can have"))
    elif mass > 0.0 and not any(moments) and name != tree.root:
        findings.append(DoctorFinding("note", place, "a mass without inertia: a point", "write it, if it matters"))
    return findings


def _complete(place: str, link: ET.Element) -> list[DoctorFinding]:
    """Write zeros for moments of inertia that are missing; Pinocchio would leave the mass out."""
    inertial, inertia = link.find("inertial"), link.find("inertial/inertia")
    missing = [key for key in TENSOR if inertia is None or inertia.get(key) is None]
    if inertial is None or not missing:
        return []
    inertia = ET.SubElement(inertial, "inertia") if inertia is None else inertia
    inertia.attrib.update(dict.fromkeys(missing, "0"))
    if number(link.find("inertial/mass"), "value") == 0.0 and len(missing) == len(TENSOR):
        return []
    return [DoctorFinding("fixed", place, f"no inertia {', '.join(missing)}", "now 0")]


def check_units(tree: UrdfTree) -> list[DoctorFinding]:
    """Return links and joints whose values seem to be in other units than kg m^2, kg, m and rad."""
    places = {name: float(np.linalg.norm(place_of(joint).translation)) for name, joint in tree.joints.items()}
    whole = sum(places.values())
    findings = [
        DoctorFinding(
            "note", f"joint '{name}'", f"a limit of {limit:g} rad, {limit / (2.0 * math.pi):.0f} turns", _DEGREES
        )
        for name, joint in tree.joints.items()
        if joint.get("type") == "revolute" and _MOST_TURNS < (limit := _largest_limit(joint)) < _NO_DEGREES
    ]
    if _LONGEST < whole < math.inf:
        text = f"the joints lie {whole:.4g} m apart in sum"
        findings.append(DoctorFinding("note", "lengths", text, "mm? Divide all lengths by 1000"))
    for name, link in tree.links.items():
        mass = number(link.find("inertial/mass"), "value")
        inertia = link.find("inertial/inertia")
        given = [number(inertia, key) for key in TENSOR if inertia is not None and inertia.get(key) is not None]
        readable = 0.0 < mass < math.inf and 0.0 < whole < math.inf and all(map(math.isfinite, given))
        if name == tree.root or not readable:
            continue
        ends = [places[joint] for joint in tree.borne.get(name, ())]
        centre = float(np.linalg.norm(place_of(link.find("inertial")).translation))
        size = max([centre, *ends])
        gyration = math.sqrt(max(float(principal_moments(link)[2]), 0.0) / mass)
        if gyration > whole:
            text = f"a radius of gyration of {gyration:.2g} m on a link of {size:.2g} m"
            findings.append(DoctorFinding("note", f"link '{name}'", text, "kg mm^2? Divide the inertia by 1e6"))
        if mass > _DENSEST * max(size, _SMALLEST_PART * whole) ** 3:
            text = f"a mass of {mass:g} kg on a link of {size:.2g} m, denser than metals"
            findings.append(DoctorFinding("note", f"link '{name}'", text, "g? Divide the mass by 1000"))
    return findings


def _largest_limit(joint: ET.Element) -> float:
    """Return the largest position limit of a joint, in rad; 0 without limits that can be read."""
    limit = joint.find("limit")
    values = [abs(number(limit, key)) for key in ("lower", "upper")]
    return max(values) if all(map(math.isfinite, values)) else 0.0


def check_placements(tree: UrdfTree) -> list[DoctorFinding]:
    """Return the vectors that are not three finite numbers, and axes without a direction."""
    elements = [(f"link '{name}'", link) for name, link in tree.links.items()]
    elements += [(f"joint '{name}'", joint) for name, joint in tree.joints.items()]
    return [DoctorFinding("refused", place, *wrong) for place, element in elements for wrong in wrong_places(element)]


def check_meshes(tree: UrdfTree, urdf: Path, packages: Sequence[Path]) -> list[DoctorFinding]:
    """Return the meshes that are missing, or outside the folder of the URDF or of their package.

    Args:
        tree: The arm.
        urdf: Its file.
        packages: Folders that hold ROS packages, searched before those around the file.
    """
    names = list(dict.fromkeys(mesh.get("filename", "") for link in tree.links.values() for mesh in link.iter("mesh")))
    wrong: dict[str, list[str]] = {}
    for name in names:
        try:
            said = _wrong(name, urdf.resolve().parent, packages)
        except (OSError, RuntimeError):  # a name that is too long, links in a circle
            said = _NOT_FOUND
        wrong.setdefault(said, []).append(quoted(name))
    findings = []
    for said, found in wrong.items():
        hint = "--package-path DIR names a folder with its package; " if "package://" in found[0] else ""
        if said:
            text = f"{len(found)} of {len(names)} {said}: {few(found)}"
            findings.append(
                DoctorFinding("note", "meshes", text, f"{hint}runs need none, and draw such links as bones")
            )
    return findings


def _wrong(name: str, folder: Path, packages: Sequence[Path]) -> str:
    """Return the problem of the mesh of a name; "" without a problem."""
    roots, inner = [folder], name.removeprefix("file://")
    if name.startswith("package://"):
        package, _, inner = name.removeprefix("package://").partition("/")
        roots = list(_package_folders(folder, package, packages))
    for root in roots:
        path = (root / inner).resolve()
        if not path.is_relative_to(root.resolve()):
            return "outside of the folder of its URDF or package"
        if path.is_file():
            return ""
    return _NOT_FOUND


def _package_folders(folder: Path, package: str, packages: Sequence[Path]) -> Iterator[Path]:
    """Yield possible folders of a ROS package: in the given folders, and in or around the URDF's."""
    yield from (place / package for place in packages)
    for around in (folder, *folder.parents):
        if around.name == package:
            yield around
        yield around / package
    yield folder
