"""Caveats of the compared sweeps."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from runner.reporting.comparison.operand import Side


@dataclass(frozen=True)
class SideCaveat:
    """A rule that was sprung in a sweep.

    Attributes:
        side: Name of the sweep.
        rule: Name of the rule.
        count: Number of cells in which it was.
        cells: Number of cells that the sweep has.
        worst: What it found where it measured most.
    """

    side: str
    rule: str
    count: int
    cells: int
    worst: str


def caveats_of(side: Side) -> list[SideCaveat]:
    """Return the rules that were sprung in a sweep, those of most cells first."""
    sprung: dict[str, list[Mapping[str, Any]]] = {}
    for found in side.measurements.caveats:
        for caveat in found:
            sprung.setdefault(str(caveat["rule"]), []).append(caveat)
    cells = len(side.measurements.hashes)
    return [
        SideCaveat(side.name, rule, len(found), cells, str(max(found, key=lambda one: float(one["value"]))["text"]))
        for rule, found in sorted(sprung.items(), key=lambda item: -len(item[1]))
    ]
