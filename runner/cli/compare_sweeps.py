"""Comparison of sweeps for `runner compare`: config differences, matched cells and metrics."""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from runner.base.sanitize import one_line
from runner.cli.columns import COMPARED, align_columns, answer_cells, number
from runner.reporting.answers import EXPLAINED, Asked, judge
from runner.reporting.comparison.cells import label_text
from runner.reporting.comparison.differences import Beyond, Value
from runner.reporting.comparison.messages import NOISE_ALONE, POOLED, cells_told, size_told
from runner.reporting.comparison.operand import SideCaveat, caveats_of, letter, open_side, stored_part
from runner.reporting.comparison.sweeps import MetricComparison, SweepComparison, compare_sweeps
from runner.reporting.sweep.subject import first_screen, whole_metrics
from runner.store import open_sweep
from runner.sweeps.finer_step import work_out_sweep

_NAMED = 3  # cells of one sweep alone


def print_sweeps(folders: Sequence[Path], metrics: Sequence[str]) -> None:
    """Print how each sweep but the first differs from the first.

    Args:
        folders: Folders of two or more sweeps.
        metrics: Names of metrics; empty for all.

    Raises:
        RunnerError: If two share no cell, or have no such metric.
        StoreError: If one cannot be read.
    """
    for folder in folders:
        work_out_sweep(stored_part(open_sweep(folder))[0])
    sides = [open_side(letter(place), folder) for place, folder in enumerate(folders)]
    for side in sides:
        for damage in side.damage:
            print(f"runner: {damage}", file=sys.stderr)
    found = [compare_sweeps(sides[0], side, metrics) for side in sides[1:]]
    print("\n\n".join("\n".join(_lines(one, metrics)) for one in found))


def _lines(found: SweepComparison, metrics: Sequence[str]) -> Iterator[str]:
    a, b = found.a, found.b
    for side in (a, b):
        yield one_line(f"{side.name}  {side.folder}  {size_told(side)}")
    yield ""
    yield one_line(found.beyond.in_words(a.name, b.name))
    yield from _values(found.beyond, a.name, b.name)
    yield from map(one_line, cells_told(found))
    caveats = [*caveats_of(a), *caveats_of(b)]
    yield f"caveats:\n{align_columns(list(map(_caveat, caveats)))}" if caveats else "no caveats"
    yield ""
    first = first_screen(metrics or whole_metrics([one.metric for one in found.pooled]))
    answers = judge([Asked(one.metric, one.unit, one.comparison) for one in found.pooled], first)
    yield from (answer.sentence(a.name, b.name) for answer in answers if answer.metric in first)
    n = len(found.matched.labels)
    over = "in the one cell" if n == 1 else f"over all {n} cells"
    yield f"every metric {over}, on the same seeds"
    header = [
        "metric",
        "unit",
        a.name,
        b.name,
        f"{b.name} - {a.name}",
        *COMPARED,
        f"{b.name} is",
        "cells below, above 0",
    ]
    rows = [[*_head(one), *answer_cells(answer), f"{one.below}, {one.above}"]
            for one, answer in zip(found.pooled, answers, strict=True)]  # fmt: skip
    yield align_columns([header, *rows], indent="")
    if found.cells:
        yield ""
        yield f"largest differences in one cell, relative to the metric (chosen from {found.candidates}, not tested):"
        rows = [[label_text(one.cell), *_head(one), number(one.comparison.difference)] for one in found.cells]
        yield align_columns([["cell", *header[:5]], *rows])
    yield ""
    yield f"{POOLED} {EXPLAINED}"
    if found.noise_alone:
        yield NOISE_ALONE


def _values(found: Beyond, a: str, b: str) -> Iterator[str]:
    """Yield tables of the values that differ, and of what made the runs."""
    values = [*found.options, *found.values]
    if values:
        yield align_columns([["key", a, b, "at"], *map(_value, values)])
    if found.provenance:
        yield f"provenance differs:\n{align_columns([['made by', a, b, ''], *map(_value, found.provenance)])}"
    else:
        yield "same provenance"


def _value(value: Value) -> list[str]:
    return [value.key, value.a, value.b, value.cells]


def _caveat(found: SideCaveat) -> list[str]:
    return [found.side, found.rule, f"{found.count} of {found.cells} cells", found.worst]


def _head(one: MetricComparison) -> list[str]:
    return [one.metric, one.unit, *map(number, one.comparison.medians)]
