"""What each source prints, place by place: the list that the audit is counted against.

It is made from the source's text alone, in reading order, and not from the entries. It stands in
`equations/inventory.yaml` of the work:

    source: xarm7
    counted: one line for each equation with a sign of equality; ...
    places:
      - place: Inverse kinematics, page 8
        equations: [q1, p3, p4, q2, p1, p2, M, q4]
        lost: [..]                     # equations that must have stood there and that the text does not show at all
"""

from collections import Counter
from functools import lru_cache

import yaml
from pydantic import Field

from runner.audit.entry import entries
from runner.audit.sources import folder
from runner.registry import StrictModel


class Place(StrictModel):
    """A section or page.

    Attributes:
        place: Its name.
        equations: Number or name of each equation printed there, in order.
        lost: Those that must have stood there and are not in the text.
    """

    place: str
    equations: list[str]
    lost: list[str] = Field(default_factory=list)


class Inventory(StrictModel):
    """All places of a source.

    Attributes:
        source: The work.
        title: How it is cited.
        found: What is wrong with its equations, and why, in a few sentences; inline mathematics as in reports.
        counted: What counts as an equation, in a sentence.
        places: In order.
    """

    source: str
    title: str
    found: str
    counted: str
    places: list[Place]


@lru_cache(maxsize=8)
def inventory(source: str) -> Inventory:
    """Return the inventory of a source."""
    text = (folder(source) / "inventory.yaml").read_text(encoding="utf-8")
    return Inventory.model_validate(yaml.safe_load(text))


def differences(source: str) -> list[str]:
    """Return what stands in the inventory and not in the audit, and the other way round, in words; empty when equal."""
    listed = Counter((place.place, number) for place in inventory(source).places for number in place.equations)
    audited = Counter((entry.place, entry.number) for _, entry in entries(source))
    missing = [f"{place}: {number} is not audited" for place, number in (listed - audited).elements()]
    return missing + [f"{place}: {number} is not in the inventory" for place, number in (audited - listed).elements()]
