"""Comparison of the levels of one sweep axis, for `runner compare SWEEP --by AXIS`."""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from runner.base.sanitize import one_line
from runner.cli.columns import COMPARED, align_columns, answer_cells
from runner.reporting.answers import EXPLAINED, Asked, judge
from runner.reporting.comparison.cells import label_text
from runner.reporting.comparison.messages import NOISE_ALONE, format_count
from runner.reporting.comparison.operand import Side, caveats_of, open_side, stored_part
from runner.reporting.comparison.pairs import levels
from runner.reporting.comparison.sweeps import noise_alone
from runner.reporting.sweep.subject import first_screen, whole_metrics
from runner.store import open_sweep
from runner.sweeps.finer_step import work_out_sweep


def print_levels(folder: Path, axis: str, within: Sequence[str] | None, metrics: Sequence[str]) -> None:
    """Print how the levels of an axis differ from the first one.

    Args:
        folder: Folder of the sweep.
        axis: The axis.
        within: Axes within whose levels they are compared; None for over all others, and within all of them.
        metrics: Names of metrics; empty for all.

    Raises:
        RunnerError: If the sweep has no such axis or metric.
        StoreError: If it cannot be read.
    """
    work_out_sweep(stored_part(open_sweep(folder))[0])
    side = open_side("A", folder)
    for damage in side.damage:
        print(f"runner: {damage}", file=sys.stderr)
    print("\n".join(_lines(side, axis, within, metrics)))


def _lines(side: Side, axis: str, within: Sequence[str] | None, metrics: Sequence[str]) -> Iterator[str]:
    measurements = side.measurements
    found = levels(measurements, axis, within, metrics)
    cells = len(measurements.hashes)
    yield one_line(f"{side.folder}  {cells} cells, by {axis}; repetitions in each: {measurements.repetitions}")
    if side.missing:
        yield one_line(
            f"{format_count(side.missing, 'cell is', 'cells are')} not stored; continue with: {side.command}"
        )
    if side.failed:
        yield f"{format_count(side.failed, 'cell', 'cells')} failed; a failed repetition counts as beyond every number"
    along = [difference for difference in measurements.differences if axis in difference.axes or not difference.axes]
    if along:
        yield f"the levels of {axis} differ in more than {axis}; what follows may be due to any of these:"
        rows = [
            [difference.key, "; ".join(f"{levels_}: {text}" for levels_, text in difference.values)]
            for difference in along
        ]
        yield align_columns(rows)
    else:
        yield f"the levels of {axis} differ in {axis} alone"
    caveats = [[one.rule, f"{one.count} of {one.cells} cells", one.worst] for one in caveats_of(side)]
    yield f"caveats:\n{align_columns(caveats)}" if caveats else "no caveats"
    yield ""
    first = first_screen(metrics or whole_metrics({one.metric: None for one in found}))
    answers = judge([Asked(one.metric, one.unit, one.comparison) for one in found], first)
    for one, answer in zip(found, answers, strict=True):
        if one.metric in first and not one.pair.at:
            yield one_line(answer.sentence(one.pair.first, one.pair.second))
    header = ["at", axis, "metric", "unit", "difference", *COMPARED, "the second is"]
    rows = []
    for one, answer in zip(found, answers, strict=True):
        names = [label_text(one.pair.at) if one.pair.at else "all", f"{one.pair.first}, {one.pair.second}"]
        rows.append([*names, one.metric, one.unit, *answer_cells(answer)])
    yield align_columns([header, *rows], indent="")
    yield ""
    yield EXPLAINED
    if measurements.repetitions > 1 and noise_alone(config for config, _ in measurements.configs):
        yield NOISE_ALONE
