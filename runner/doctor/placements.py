"""The places and axes that a URDF gives as texts of numbers."""

import math

from runner.doctor.finding import Finding
from runner.robots.tree import UrdfTree, moves


def check_placements(tree: UrdfTree) -> list[Finding]:
    """Return the vectors that are not three finite numbers, and axes without a direction."""
    elements = [(f"link '{name}'", link) for name, link in tree.links.items()]
    elements += [(f"joint '{name}'", joint) for name, joint in tree.joints.items()]
    findings = []
    for place, element in elements:
        for part in element.iter():
            for key in ("xyz", "rpy") if part.tag in ("origin", "axis") else ():
                words = part.get(key)
                if words is not None and not _is_vector(words):
                    text = f'<{part.tag} {key}="{words}">'
                    findings.append(Finding("refused", place, text, "allowed: three numbers, parted by spaces"))
                elif part.tag == "axis" and moves(element) and words and not any(map(float, words.split())):
                    findings.append(Finding("refused", place, "an axis of length 0", "give it a direction"))
    return findings


def _is_vector(text: str) -> bool:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return False
    return len(values) == 3 and all(map(math.isfinite, values))
