"""Text of a comparison for a terminal: levels of an axis, two sweeps, or two runs."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from runner.base.dotted_keys import dotted, leaves
from runner.base.machine import read_machine
from runner.base.sanitize import one_line
from runner.reporting.answers import EXPLAINED, HEADER, PAIRS, Answer
from runner.reporting.asked import AskedComparison, ask
from runner.reporting.comparison.differences import Value, find_differences
from runner.reporting.comparison.pairs import label_text, match
from runner.reporting.comparison.sweeps import (
    FAILED,
    NOISE_ALONE,
    POOLED,
    SweepComparison,
    compare_runs,
    counts_by_sign,
    format_count,
    missing_cells_text,
    noise_alone,
    size_told,
)
from runner.reporting.sentences import sentences, short_table
from runner.reporting.sweep.subject import main_metrics
from runner.reporting.table import Cell, Number, Table, numbers, terminal
from runner.store.run import Run
from runner.store.seal import simulated_part
from runner.sweeps.measurements import Measurements

ALL = "--all prints every metric and the method, --json all numbers."
"""Last line of a short comparison."""

_MOST_ROWS = 15  # of a short table
# Possible causes of a difference besides the config; date and command do not affect the result.
_PROVENANCE = ("commit", "versions", "plant_step")


def level_lines(side: Measurements, axis: str, answers: Sequence[Answer], everything: bool) -> Iterator[str]:
    """Yield the comparison of the levels of an axis: answers first; with `everything` all metrics and the method."""
    yield one_line(f"{side.folder}  {size_told(side)}; by {axis}")
    if side.missing:
        yield one_line(missing_cells_text(side))
    if side.failed:
        yield f"{format_count(side.failed, 'cell', 'cells')} failed; {FAILED}"
    along = [one for one in side.differences if axis in one.axes or not one.axes]
    if along:
        yield f"the levels of {axis} differ in more than {axis}; what follows may be due to any of these:"
        keys = [[one.key, "; ".join(f"{at}: {text}" for at, text in one.values)] for one in along]
        yield terminal(Table("", ["", ""], keys))
    else:
        yield f"the levels of {axis} differ only in {axis}"
    yield ""
    yield from map(one_line, sentences(answers))
    yield from _doubt_lines([side])
    yield ""
    if not everything:
        yield from _short_lines(answers)
        return
    rows: list[list[Cell]] = [
        [one.place, ", ".join(one.names), one.metric, one.unit, *one.plain_cells] for one in answers
    ]
    yield terminal(Table("", ["at", axis, "metric", "unit", *numbers(*HEADER), "the second is"], rows), indent="")
    yield ""
    yield EXPLAINED


def sweep_lines(found: SweepComparison, everything: bool) -> Iterator[str]:
    """Yield the comparison of two sweeps; with `everything` all metrics, the method and the largest differences."""
    pairs, differences = found.pairs, found.differences
    a, b = pairs.first, pairs.second
    for side in (pairs.a, pairs.b):
        yield one_line(f"{side.name}  {side.folder}  {size_told(side)}")
    yield ""
    yield one_line(differences.in_words(a, b))
    values = [*differences.options, *differences.values]
    if len(values) > 1:
        yield terminal(Table("", ["key", a, b, "at"], list(map(_value, values))))
    if differences.provenance:
        made_by = Table("", ["made by", a, b, ""], list(map(_value, differences.provenance)))
        yield f"provenance differs:\n{terminal(made_by)}"
    yield from map(one_line, found.cells_told())
    yield ""
    yield from map(one_line, sentences(found.answers))
    yield from _doubt_lines([pairs.a, pairs.b])
    yield ""
    if not everything:
        yield from _short_lines(found.answers)
        return
    yield f"every metric {'in the one cell' if len(pairs) == 1 else f'over all {len(pairs)} cells'}, on the same seeds"
    header = ["metric", "unit", *numbers(a, b, f"{b} - {a}")]
    rows = [[*_head(one), *one.plain_cells, "{}, {}".format(*counts_by_sign(one))] for one in found.answers]
    columns = [*header, *numbers(*HEADER[1:]), f"{b} is", "cells below, above 0"]
    yield terminal(Table("", columns, rows), indent="")
    if found.cells:
        yield ""
        yield f"largest differences in one cell, relative to the metric (chosen from {found.candidates}, not tested):"
        rows = [[label_text(one.at), *_head(one), Number(one.comparison.difference)] for one in found.cells]
        yield terminal(Table("", ["cell", *header], rows))
    yield ""
    yield f"{POOLED} {EXPLAINED}"


def run_lines(
    runs: tuple[Run, Run], sides: tuple[Measurements, Measurements], metrics: Sequence[str], everything: bool
) -> Iterator[str]:
    """Yield the comparison of two runs; with `everything` all metrics, the method and same configs."""
    a, b = (side.name for side in sides)
    for side, run in zip(sides, runs, strict=True):
        yield one_line(f"{side.name}  {run.folder}  {run.failure or run.status}")
    yield ""
    pairs = match(*sides)
    yield one_line(find_differences(pairs).in_words(a, b))
    yield _changed_keys("config", [simulated_part(run.config) for run in runs], [a, b])
    if runs[0].urdf != runs[1].urdf:
        yield "  the text of robot.urdf differs"
    made_by = [
        {key: run.provenance[key] for key in _PROVENANCE if key in run.provenance}
        | {"machine": {part: text for part, text in read_machine(run.provenance["machine"]).record().items() if text}}
        for run in runs
    ]
    yield _changed_keys("provenance", made_by, [a, b])
    yield ""
    names = metrics or ([name for side in sides for name in side.values] if everything else main_metrics(sides))
    answers, why = compare_runs(*sides, metrics if metrics or not everything else names)
    yield from map(one_line, sentences(answers) if answers else [why])
    yield from _doubt_lines(sides)
    yield ""
    if answers and not everything:
        yield from _short_lines(answers)
        return
    header = ["metric", "unit", *numbers(a, b, f"{b} - {a}", f"{b} / {a}")]
    yield terminal(Table("", header, list(_metric_rows(sides, names))), indent="")
    if answers:
        yield ""
        header = ["metric", "unit", *numbers(f"{b} - {a}", *HEADER[1:]), f"{b} is"]
        yield terminal(Table("", header, [[one.metric, one.unit, *one.plain_cells] for one in answers]))
        yield EXPLAINED
        return
    both = [name for name in dict.fromkeys(names) if all(name in side.values for side in sides)]
    rounded = [one.metric for one in ask([pairs], both) if one.comparison.rounding and one.within_rounding]
    if rounded and pairs.share_seeds.all():
        yield f"equal up to rounding, which changes them as much: {', '.join(rounded)}"
    if not everything:
        yield ALL


def _short_lines(answers: Sequence[Answer]) -> Iterator[str]:
    """Yield the short table, and how to print more."""
    header, rows = short_table(answers)
    yield terminal(Table("", header, rows[:_MOST_ROWS]), indent="")
    if len(rows) > _MOST_ROWS:
        yield f"{len(rows) - _MOST_ROWS} more rows"
    yield ""
    if any(one.interval for one in answers):
        yield PAIRS
    yield ALL


def _doubt_lines(sides: Sequence[Measurements]) -> Iterator[str]:
    """Yield what may mislead: the caveats, and repetitions that draw noise only."""
    found: dict[tuple[str, str], list[str]] = {}
    for side in sides:
        for rule, count, _, text in side.caveats_by_rule():
            name = side.name if len(sides) > 1 else ""
            cells = "" if len(side.hashes) == 1 else f"{count} of {len(side.hashes)} cells"
            found.setdefault((rule, text), []).append(f"{name} {cells}".strip())
    for (rule, text), places in found.items():
        yield one_line(f"May mislead: {rule} ({', '.join(places)}): {text}.")
    if noise_alone(sides):
        yield NOISE_ALONE


def _changed_keys(what: str, both: Sequence[Mapping[str, Any]], names: Sequence[str]) -> str:
    """Return a table of the dotted keys in which two mappings differ, or a message that they are equal."""
    a, b = ({dotted(place): _shown(value) for place, value in leaves(one, lists=False)} for one in both)
    rows = [[key, a.get(key, "(absent)"), b.get(key, "(absent)")] for key in {**a, **b} if a.get(key) != b.get(key)]
    return f"{what} differs:\n{terminal(Table('', ['key', *names], rows))}" if rows else f"same {what}"


def _shown(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def _metric_rows(sides: tuple[Measurements, Measurements], names: Sequence[str]) -> Iterator[list[Cell]]:
    """Yield the medians of each metric in two runs, their difference and their ratio."""
    for name in dict.fromkeys(names):
        unit = next(side.units[name] for side in sides if name in side.units)
        a, b = (float(side.medians(name)[0]) if name in side.values else np.nan for side in sides)
        shown = (a, b, b - a, b / a if a and np.isfinite(a) else np.nan)
        yield [name, unit, *(Number(value if np.isfinite(value) else None) for value in shown)]


def _value(value: Value) -> list[str]:
    return [value.key, value.a, value.b, value.cells]


def _head(one: AskedComparison) -> list[Cell]:
    return [one.metric, one.unit, *map(Number, one.comparison.medians)]
