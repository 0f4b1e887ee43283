"""Tables over the runs of a pattern."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from runner.base.errors import RunnerError, nearest
from runner.base.quantities import above_rounding, label_with_unit, number, smaller_units
from runner.papers.study.measured import Measured
from runner.papers.study.results import MatchedRun, Runs, axes_of, called, matching_runs, other
from runner.papers.study.run_values import Signal
from runner.reporting import table as typed
from runner.reporting.document import Origin, Table
from runner.reporting.figures import origin
from runner.reporting.metric_titles import title
from runner.reporting.table import Cell, Number
from runner.store import Run

_NEVER = "never"
_NUMBER = re.compile(r"[-−]?\d")


@dataclass(frozen=True)
class RunColumn:
    """A column of a table over runs.

    Attributes:
        title: Its header.
        cell: Returns its cell for a run, from the study's runs and the run.
        metric: The metric that it shows, whose unit its title takes.
        levels: Axes that it is about, with the levels that it names of them.
    """

    title: str
    cell: Callable[[Runs, MatchedRun], Cell]
    metric: str = ""
    levels: Mapping[str, Sequence[str]] = field(default_factory=dict)


def level(axis: str, title: str = "", words: Mapping[str, str] | None = None, missing: str = "–") -> RunColumn:
    """Return a column with the level of an axis.

    Args:
        axis: The axis, as the pattern names it.
        title: Header; the name of the axis if it is omitted.
        words: What a level is called; others are called as they are.
        missing: What stands for runs of a pattern without that axis.
    """

    def text(_runs: Runs, row: MatchedRun) -> str:
        return called(f"{{{axis}}}", row.levels, words or {}) if axis in row.levels else missing

    return RunColumn(title or axis, text, levels={axis: ()})


def column(
    title: str,
    what: Signal,
    *others: str,
    digits: int = 3,
    rounding: float | None = None,
    only: Mapping[str, str | Sequence[str]] | None = None,
    though_failed: bool = False,
) -> RunColumn:
    """Return a column with a number of each run.

    A failed run says so; a settling time without a value is "never", another number without one a dash.

    Args:
        title: Header; the unit of a metric is added unless it has one.
        what: Name of a metric, or a function of the run, or of these others, that gives a number or a string.
        others: Names of the runs that it is a number of, with axes in braces; the row's own run where there are none.
        digits: How many digits.
        rounding: Smaller numbers are shown as rounding errors, in the unit of the title; 0 shows all digits of every
            number; None stands for rounding errors in SI units.
        only: Levels by axis of the rows that have it; the others have a dash.
        though_failed: Whether what a function reads of a run until it failed is shown.
    """

    def found_cell(runs: Runs, row: MatchedRun) -> Cell:
        if any(row.levels.get(axis) not in own for axis, own in chosen.items()):
            return Number(None)
        of = [other(runs, name, row.levels) for name in others] or [row.run]
        cell = _number(what, of, digits, though_failed)
        return (
            cell if rounding is None or isinstance(cell, str) else number(cell.value, digits, rounding, rounding == 0)
        )

    chosen = {axis: [own] if isinstance(own, str) else own for axis, own in (only or {}).items()}
    return RunColumn(title, found_cell, what if isinstance(what, str) else "", chosen)


def table(
    runs: Runs,
    caption: str,
    pattern: str | Sequence[str],
    *columns: RunColumn,
    by: Sequence[str] = (),
    number: str = "",
) -> Table:
    """Return a table with a row for each run that a pattern stands for; one that several stand for is listed once.

    Args:
        runs: The runs of the study by name.
        caption: What it lists; inline mathematics as in Text.
        pattern: Names of the runs, with axes in braces, or several of them.
        columns: Its columns; a run has another row where a cell differs, as by its level.
        by: Axes from the outermost to the innermost loop.
        number: Its number in the source.
    """
    patterns = [pattern] if isinstance(pattern, str) else pattern
    rows = [
        row for each in patterns for row in matching_runs(runs, each, [axis for axis in by if axis in axes_of(each)])
    ]
    for each in columns:
        _check_levels(each, rows)
    cells = {(row.run.hash, tuple(each.cell(runs, row) for each in columns)): None for row in rows}
    header = [_header(each, rows) for each in columns]
    return _table(caption, header, [own for _, own in cells], origin(rows[0].run, number))


def _check_levels(given: RunColumn, rows: Sequence[MatchedRun]) -> None:
    """Refuse a column about an axis or a level that no row has."""
    for axis, levels in given.levels.items():
        axes = dict.fromkeys(own for row in rows for own in row.levels)
        if axis not in axes:
            raise RunnerError(f"no axis '{axis}'{nearest(axis, axes)}; axes: {', '.join(axes) or 'none'}")
        there = list(dict.fromkeys(row.levels[axis] for row in rows if axis in row.levels))
        for level in levels:
            if level not in there:
                known = f"{nearest(level, there)}; levels: {', '.join(there)}"
                raise RunnerError(f"axis '{axis}' has no level '{level}'{known}")


def comparison(
    runs: Runs,
    caption: str,
    pattern: str,
    *metrics: str,
    words: Mapping[str, str] | None = None,
    number: str = "",
) -> Table:
    """Return a table with a row for each metric and a column for each level of a pattern's axis, such as presets."""
    if len(axes_of(pattern)) != 1:
        raise RunnerError(f"'{pattern}': a comparison goes over one axis in braces")
    shown = matching_runs(runs, pattern)
    rows = [[title(metric), *(_with_unit(metric, each.run) for each in shown)] for metric in metrics]
    header = ["metric", *(called(f"{{{axes_of(pattern)[0]}}}", each.levels, words or {}) for each in shown)]
    return Table(caption, header, rows, origin(shown[0].run, number), prose=True)


def listing(
    runs: Runs,
    caption: str,
    run: str,
    header: Sequence[str],
    *rows: Sequence[Cell | float | Measured | None],
    number: str = "",
) -> Table:
    """Return a table whose cells are written in the chapter, with the command of a run if one is named."""
    cells = [[_cell(cell) for cell in row] for row in rows]
    return _table(caption, header, cells, origin(runs[run], number) if run else Origin(number))


def _table(caption: str, header: Sequence[str], cells: Sequence[Sequence[Cell]], origin: Origin) -> Table:
    """Return a table; a length or time at the end of a title, "(m)" or "(s)", is the unit of the column's numbers."""
    columns = []
    for index, head in enumerate(header):
        kind: Literal["number", "text"] = "number" if _are_numbers([row[index] for row in cells]) else "text"
        name, _, unit = head.removesuffix(")").rpartition(" (")
        has_unit = head.endswith(")") and smaller_units(unit)
        columns.append(typed.Column(name, kind, unit) if has_unit else typed.Column(head, kind))
    return Table(caption, columns, cells, origin, prose=True)


def _are_numbers(cells: Sequence[Cell]) -> bool:
    """Return True if some cell is a number, no cell is another string, and the others are missing."""
    texts = [cell for cell in cells if cell not in ("–", _NEVER, "failed")]
    known = [cell for cell in texts if isinstance(cell, str) or cell.value is not None or cell.low is not None]
    return bool(known) and all(isinstance(cell, Number) or _NUMBER.match(cell) for cell in known)


def _number(what: Signal, runs: Sequence[Run], digits: int, though_failed: bool = False) -> Cell:
    if not though_failed and any(run.status == "failed" for run in runs):
        return "failed"
    if not isinstance(what, str):
        return _cell(what(*runs), digits)
    never = what.startswith("settling_time") and runs[0].median(what) is None
    return _NEVER if never else Number(runs[0].median(what), digits=digits)


def _with_unit(metric: str, run: Run) -> str:
    cell = _number(metric, [run], 3)
    return cell if isinstance(cell, str) else above_rounding(cell.value, _unit(run, metric))


def _cell(value: Cell | float | Measured | None, digits: int = 3) -> Cell:
    if isinstance(value, Cell):
        return value
    return Number(value.value if isinstance(value, Measured) else value, digits=digits)


def _header(given: RunColumn, rows: Sequence[MatchedRun]) -> str:
    if not given.metric or given.title.endswith(")"):
        return given.title
    return label_with_unit(given.title, next((_unit(row.run, given.metric) for row in rows if row.run.metrics), "1"))


def _unit(run: Run, metric: str) -> str:
    return run.metrics[metric].unit if metric in run.metrics else "1"
