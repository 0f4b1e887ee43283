"""The best and the worst cell, and whether the best is better than those behind it."""

from collections.abc import Sequence

import numpy as np

from runner.comparison.pairs import CellPairs, compare, share_seeds
from runner.errors import StoreError
from runner.quantities import with_ends
from runner.reporting.document import Block, Notice, Section, Table, Text
from runner.reporting.figures import playback, torque_and_error
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title
from runner.reporting.sweep.pairs import HEADER, columns
from runner.reporting.sweep.subject import Subject
from runner.statistics import median_interval
from runner.store import Run

_BEHIND = 5
_EXPLAINED = (
    "median of the differences, its 95 % interval from n pairs, effect size (rank-biserial correlation, 1 where the "
    "best is better in every repetition), and p of the signed-rank test. The best was chosen by the first metric, "
    "which makes it look better there than it is"
)


def section(subject: Subject, best: Run, worst: Run) -> Section:
    """Return the best and the worst cell with their motion.

    Args:
        subject: The sweep, with at least one ranked cell.
        best: Run of the first ranked cell.
        worst: Run of the last ranked cell.
    """
    ranked = subject.ranked
    ends = [ranked[0], ranked[-1]] if len(ranked) > 1 else [ranked[0]]
    blocks: list[Block] = [_medians(subject, ends)]
    if len(ranked) > 1:
        blocks += _behind(subject, ranked)
    sections = [_motion(f"Best: {subject.cell_name(ranked[0])}", best)]
    if len(ranked) > 1:
        sections.append(_motion(f"Worst: {subject.cell_name(ranked[-1])}", worst))
    return Section("Best and worst", blocks, sections)


def _medians(subject: Subject, cells: Sequence[int]) -> Table:
    rows = []
    for name in subject.metrics:
        unit = subject.measurements.units[name]
        rows.append(
            [
                literal(title(name)),
                *(_with_interval(subject.measurements.of_cell(name, cell), unit) for cell in cells),
            ]
        )
    header = ["metric", *(literal(subject.cell_name(cell)) for cell in cells)]
    return Table(
        "Best and worst cell: medians, in brackets their 95 % intervals by the bootstrap over n repetitions.",
        header,
        rows,
        tuple(range(1, len(header))),
    )


def _with_interval(values: np.ndarray, unit: str) -> str:
    if not values.size:
        return "–"
    interval = median_interval(values)
    text, ends, _ = with_ends(interval.median, interval.low, interval.high, unit)
    return f"{text} (n = {interval.n})" if interval.low is None else f"{text} ({ends}, n = {interval.n})"


def _behind(subject: Subject, ranked: Sequence[int]) -> list[Block]:
    """Compare the cells next to the best with it, repetition by repetition, in each metric."""
    measurements = subject.measurements
    others = np.array(ranked[1:])
    pairs = CellPairs(np.full(len(others), ranked[0]), others)
    shared = others[share_seeds(measurements, measurements, pairs)][:_BEHIND].tolist()
    if not shared:
        return [Text("Cells are not compared in pairs: the sweep varies the seed, so that no two share their noise.")]
    tables: list[Block] = []
    for metric in subject.metrics:
        values, rows = measurements.values[metric], []
        for cell in shared:
            comparison = compare(values, values, CellPairs(np.array(ranked[:1]), np.array([cell])))
            if comparison is not None:
                told = columns(comparison, measurements.units[metric])
                rows.append([literal(subject.cell_name(cell)), *told, comparison.verdict])
        explained = f", on the same seeds: {_EXPLAINED}" if not tables else "; the best and its followers as above"
        caption = f"The next cells against the best, by {title(metric)}{explained}."
        tables.append(Table(caption, ["cell", *HEADER, "than the best"], rows, tuple(range(1, 1 + len(HEADER)))))
    return tables


def _motion(title: str, run: Run) -> Section:
    try:
        blocks: list[Block] = [
            torque_and_error(run, "Torque of each joint and tip position error, repetition 0."),
            playback(run, "The motion of repetition 0."),
        ]
    except StoreError as error:
        blocks = [Notice("warning", "No motion to show", literal(str(error)))]
    return Section(title, blocks)
