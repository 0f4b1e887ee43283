"""Checks of an arm's links: vectors, masses, moments of inertia and mesh files."""

import contextlib
import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from pathlib import Path

from runner.base.sanitize import few, quoted
from runner.doctor.finding import Finding
from runner.robots.inertials import fix_inertia, impossible_inertia, make_massless, principal_moments
from runner.robots.tree import TENSOR, UrdfTree, absurd_inertial, number, wrong_places


def check_links(tree: UrdfTree) -> list[Finding]:
    """Return the problems of the inertials of a tree's links, and fix in place what leaves no choice."""
    return [finding for name, link in tree.links.items() for finding in _check_link(tree, name, link)]


def _check_link(tree: UrdfTree, name: str, link: ET.Element) -> list[Finding]:
    place = f"link '{name}'"
    if link.find("inertial/mass") is None:
        bare = link.find("inertial") is None
        make_massless(link)
        text = "no <inertial>: a frame without mass" if bare else "an <inertial> without <mass>"
        return [Finding("note" if bare else "fixed", place, text, "" if bare else "now without mass")]
    findings = _complete(place, link)
    mass = number(link.find("inertial/mass"), "value")
    moments = [number(link.find("inertial/inertia"), key) for key in TENSOR]
    if not 0.0 <= mass < math.inf:
        return [Finding("refused", place, f"mass {mass:g} kg", "allowed: 0 or more")]
    if not all(map(math.isfinite, moments)):
        return [Finding("refused", place, "an inertia that is not a finite number", "write all six moments, in kg m^2")]
    absurd = [Finding("refused", place, text) for text in absurd_inertial(link)]
    if absurd:
        return absurd
    wrong = impossible_inertia(link)
    if wrong:
        fix_inertia(link)
        now = ", ".join(f"{moment:.3g}" for moment in principal_moments(link))
        findings.append(Finding("fixed", place, wrong[0], f"now {now} kg m^2, the nearest that a body can have"))
    elif mass > 0.0 and not any(moments) and name != tree.root:
        findings.append(Finding("note", place, "a mass without inertia: a point", "write it, if it matters"))
    return findings


def _complete(place: str, link: ET.Element) -> list[Finding]:
    """Write zeros for moments of inertia that are missing; Pinocchio would leave the mass out."""
    inertial, inertia = link.find("inertial"), link.find("inertial/inertia")
    missing = [key for key in TENSOR if inertia is None or inertia.get(key) is None]
    if inertial is None or not missing:
        return []
    inertia = ET.SubElement(inertial, "inertia") if inertia is None else inertia
    inertia.attrib.update(dict.fromkeys(missing, "0"))
    if number(link.find("inertial/mass"), "value") == 0.0 and len(missing) == len(TENSOR):
        return []
    return [Finding("fixed", place, f"no inertia {', '.join(missing)}", "now 0")]


def check_placements(tree: UrdfTree) -> list[Finding]:
    """Return the vectors that are not three finite numbers, and axes without a direction."""
    elements = [(f"link '{name}'", link) for name, link in tree.links.items()]
    elements += [(f"joint '{name}'", joint) for name, joint in tree.joints.items()]
    return [Finding("refused", place, *wrong) for place, element in elements for wrong in wrong_places(element)]


def check_meshes(tree: UrdfTree, urdf: Path, packages: Sequence[Path]) -> list[Finding]:
    """Return the meshes that are missing, or outside the folder of the URDF or of their package.

    Args:
        tree: The arm.
        urdf: Its file.
        packages: Folders that hold ROS packages, searched before those around the file.
    """
    names = list(dict.fromkeys(mesh.get("filename", "") for link in tree.links.values() for mesh in link.iter("mesh")))
    wrong: dict[str, list[str]] = {}
    for name in names:
        with contextlib.suppress(OSError, RuntimeError):  # a name that is too long, links in a circle
            wrong.setdefault(_wrong(name, urdf.resolve().parent, packages), []).append(quoted(name))
    findings = []
    for said, found in wrong.items():
        hint = "--package-path DIR names a folder with its package; " if "package://" in found[0] else ""
        if said:
            text = f"{len(found)} of {len(names)} {said}: {few(found)}"
            findings.append(Finding("note", "meshes", text, f"{hint}runs need none, and draw such links as bones"))
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
    return "not found"


def _package_folders(folder: Path, package: str, packages: Sequence[Path]) -> Iterator[Path]:
    """Yield possible folders of a ROS package: in the given folders, and in or around the URDF's."""
    yield from (place / package for place in packages)
    for around in (folder, *folder.parents):
        if around.name == package:
            yield around
        yield around / package
    yield folder
