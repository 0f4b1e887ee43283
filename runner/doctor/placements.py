"""Checks of the vectors and axes in a URDF."""

from runner.doctor.finding import Finding
from runner.robots.tree import UrdfTree
from runner.robots.urdf_values import wrong_places


def check_placements(tree: UrdfTree) -> list[Finding]:
    """Return the vectors that are not three finite numbers, and axes without a direction."""
    elements = [(f"link '{name}'", link) for name, link in tree.links.items()]
    elements += [(f"joint '{name}'", joint) for name, joint in tree.joints.items()]
    return [Finding("refused", place, *wrong) for place, element in elements for wrong in wrong_places(element)]
