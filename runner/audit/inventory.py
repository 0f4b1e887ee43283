"""Inventory of the equations in a source by section or page, as the reference for the audit's coverage.

The inventory is written from the source's text in reading order, independently of the entries. The file is
`equations/inventory.yaml` in the study's folder:

    counted: one line for each equation with a sign of equality; ...
    places:
      - place: Inverse kinematics, page 8
        equations: [q1, p3, p4, q2, p1, p2, M, q4]
        lost: [..]                     # equations that must have stood there and that the text does not show at all
"""

from collections import Counter

from pydantic import Field

from runner.audit.entry import entries
from runner.audit.sources import Where, source_of
from runner.base.data_file import read_data
from runner.schema.model import StrictModel


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
        title: How it is cited.
        found: What is wrong with its equations, and why, in a few sentences; inline mathematics as in reports.
        counted: What counts as an equation, in a sentence.
        places: In order.
    """

    title: str
    found: str
    counted: str
    places: list[Place]


def inventory(where: Where) -> Inventory:
    """Return the inventory of a source."""
    return read_data(source_of(where).equations / "inventory.yaml", Inventory)


def differences(where: Where) -> list[str]:
    """Return what stands in the inventory and not in the audit, and the other way round, in words; empty when equal."""
    listed = Counter((place.place, number) for place in inventory(where).places for number in place.equations)
    audited = Counter((entry.place, entry.number) for _, entry in entries(where))
    missing = [f"{place}: {number} is not audited" for place, number in (listed - audited).elements()]
    return missing + [f"{place}: {number} is not in the inventory" for place, number in (audited - listed).elements()]
