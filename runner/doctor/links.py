"""Checks of an arm's links: masses and moments of inertia."""

import math
import xml.etree.ElementTree as ET

from runner.doctor.finding import Finding
from runner.robots.inertials import fix_inertia, impossible_inertia, make_massless, principal_moments
from runner.robots.tree import UrdfTree
from runner.robots.urdf_values import TENSOR, absurd_inertial, number


def check_links(tree: UrdfTree) -> list[Finding]:
    """Return what is wrong with the inertials of a tree's links, and fix in place what leaves no choice."""
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
        return [Finding("refused", place, "an inertia that is no number", "write all six moments, in kg m^2")]
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
