"""The links of an arm: what they weigh, as both engines take it."""

import math
import xml.etree.ElementTree as ET

from runner.doctor.finding import Finding
from runner.robots.inertials import impossible_inertia, make_massless, mend_inertia
from runner.robots.tree import UrdfTree
from runner.robots.urdf_values import TENSOR, absurd_inertial, number


def check_links(tree: UrdfTree) -> list[Finding]:
    """Return what is wrong with the inertials of a tree's links, and mend in place what can be without a choice."""
    return [finding for name, link in tree.links.items() for finding in _check_link(tree, name, link)]


def _check_link(tree: UrdfTree, name: str, link: ET.Element) -> list[Finding]:
    place = f"link '{name}'"
    if link.find("inertial/mass") is None:
        make_massless(link)
        text = "no inertial: PyBullet makes it 1 kg, Pinocchio leaves it without mass"
        return [Finding("finding", place, text, "write its mass, or zero mass and zero inertia", True)]
    mass = number(link.find("inertial/mass"), "value")
    moments = [number(link.find("inertial/inertia"), key) for key in TENSOR]
    if not 0.0 <= mass < math.inf:
        return [Finding("refused", place, f"mass {mass:g} kg", "allowed: 0 or more")]
    if not all(map(math.isfinite, moments)):
        return [
            Finding("refused", place, "an inertia that is missing or no number", "write all six moments, in kg m^2")
        ]
    absurd = [Finding("refused", place, text) for text in absurd_inertial(link)]
    if absurd:
        return absurd
    if mass == 0.0 and not any(moments):
        return []
    if not any(moments):
        text = "a point mass: it has a mass and no inertia"
        return (
            [] if name == tree.root else [Finding("note", place, text, "write its moments of inertia, if they matter")]
        )
    wrong = impossible_inertia(link)
    if not wrong:
        return []
    mend_inertia(link)
    return [Finding("finding", place, wrong[0], "take the nearest that a body can have, or that of the CAD", True)]
