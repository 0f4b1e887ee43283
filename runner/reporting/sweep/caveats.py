"""Caveats of the cells of a sweep."""

from collections.abc import Mapping
from typing import Any

from runner.reporting.document import Block, Notice, Section, Table
from runner.reporting.markup import literal, literals
from runner.reporting.sweep.subject import Subject


def is_needed(subject: Subject) -> bool:
    """Tell whether there is something to say."""
    return any(subject.measurements.caveats) or bool(subject.measurements.caveat_changes)


def section(subject: Subject) -> Section:
    """Return the rules that were sprung, each with its number of cells and the worst one, and where rules differ."""
    measurements = subject.measurements
    cells = len(measurements.hashes)
    blocks: list[Block] = []
    sprung: dict[str, list[tuple[int, Mapping[str, Any]]]] = {}
    for cell, caveats in enumerate(measurements.caveats):
        for caveat in caveats:
            sprung.setdefault(str(caveat["rule"]), []).append((cell, caveat))
    if sprung:
        rows = []
        for rule, found in sorted(sprung.items(), key=lambda item: -len(item[1])):
            cell, worst = max(found, key=lambda entry: float(entry[1]["value"]))
            where = subject.cell_name(cell) or "the only one"
            rows.append(literals([rule, f"{len(found)} of {cells}", where, str(worst["text"])]))
        caption = "Why results may not be what they seem: rules, cells with that caveat, and the worst of them."
        blocks.append(Table(caption, ["caveat", "cells", "worst cell", "what was found there"], rows, (1,)))
    if measurements.caveat_changes:
        changes = "; ".join(f"{what} ({count} of {cells} cells)" for what, count in measurements.caveat_changes.items())
        text = literal(f"Caveats were looked for by {changes}.")
        blocks.append(Notice("warning", "Caveats by other rules than today's", text))
    return Section("Caveats", blocks)
