"""Tables for publications: rows, medians with intervals, and notes."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.quantities import ROUNDING
from runner.reporting.export.columns import escape_markdown, write_markdown
from runner.reporting.export.latex import write_latex
from runner.reporting.export.pooling import Pooled, pool
from runner.reporting.export.typst import write_typst
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import choose, key_label
from runner.reporting.table import Cell, Column, Number, Table, numbers
from runner.statistics import SMALLEST_SAMPLE, median_interval
from runner.statistics.interval import RESAMPLES
from runner.store import Run
from runner.sweeps.differing import in_words
from runner.sweeps.measurements import Measurements, measure_run


class PaperTable(NamedTuple):
    """A table for a paper.

    Attributes:
        table: The table, without caption.
        notes: How the numbers were made, and what the reader must know of them, a sentence each.
        sources: Where they come from: command, commit.
    """

    table: Table
    notes: Sequence[str]
    sources: Sequence[str]

    def written(self, form: str, width: float | None = None) -> str:
        """Return it as "markdown", "latex" or "typst", with its notes and sources.

        Args:
            form: The format.
            width: Width that LaTeX and Typst have to fit, in mm; None for any.

        Raises:
            RunnerError: If it does not fit.
        """
        caption = " ".join(self.notes)
        if form == "latex":
            return write_latex(self.table, caption, self.sources, width)
        if form == "typst":
            return write_typst(self.table, caption, self.sources, width)
        below = "  \n".join(map(escape_markdown, [caption, *self.sources]))
        return f"{write_markdown(self.table)}\n\n{below}\n"


class Sample(NamedTuple):
    """Values of a metric.

    Attributes:
        median: The median with its interval; without one if its ends are equal.
        n: Number of values.
        lost: Number of values beyond every number.
        undefined: Number of repetitions of runs that do not define the metric.
    """

    median: Number
    n: int
    lost: int
    undefined: int = 0


def summarize(values: FloatArray) -> Sample:
    """Return the median of some values, shape (n,): infinite beyond every number, NaN where there is none."""
    present = values[~np.isnan(values)]
    if not len(present):
        return Sample(Number(None), 0, 0)
    found = median_interval(present)
    ends = () if found.low == found.high else (found.low, found.high)
    return Sample(Number(found.median, *ends), found.n, int(np.isinf(present).sum()))


def of_sweep(
    measurements: Measurements,
    command: str,
    metrics: Sequence[str] | None = None,
    by: Sequence[str] | None = None,
    where: Sequence[str] = (),
) -> PaperTable:
    """Return the table of a sweep: a row for each combination of some axes, seeds put together.

    Args:
        measurements: The sweep.
        command: The command that made it.
        metrics: The metrics, a column each; None takes those that its report compares.
        by: The axes; None takes all swept axes except the seed.
        where: Values to which cells are limited, each as KEY=VALUE.

    Raises:
        RunnerError: If a metric, axis or value is none of the sweep's, or a row would mix more than seeds.
    """
    pooled = pool(measurements, by, where)
    rows = pooled.measurements
    names = choose(rows).metrics if metrics is None else rows.named(metrics)
    samples = [
        [summarize(rows.values[name][row])._replace(undefined=_undefined(measurements, name, own)) for name in names]
        for row, own in enumerate(pooled.cells)
    ]
    notes = [*_of_numbers(samples, pooled.seeds), *_of_cells(measurements, pooled)]
    fixed = f"The same in all rows: {', '.join(rows.fixed)}." if rows.fixed else ""
    commits = [text for key, texts in rows.provenance.items() if key == "commit" for text in texts]
    counts = [sorted({sample.n for sample in row}) for row in samples]
    differ = len({n for row in counts for n in row}) > 1  # else a note has the number
    cells: list[list[Cell]] = [
        [*(axis.text(int(axis.level[row])) for axis in rows.axes), *(sample.median for sample in samples[row]),
         *([", ".join(map(str, counts[row]))] if differ else [])]
        for row in range(len(samples))
    ]  # fmt: skip
    header = [
        *(key_label(axis) for axis in rows.axes),
        *(Column(title(name), "number", rows.units[name]) for name in names),
        *(numbers("n") if differ else []),
    ]
    sources = [f"From: {command}", *(f"Commit: {commit}" for commit in commits)]
    return PaperTable(Table("", header, cells), [*notes, *([fixed] if fixed else [])], sources)


def of_run(run: Run, metrics: Sequence[str] | None = None) -> PaperTable:
    """Return the table of one run: a row for each metric.

    Args:
        run: The run.
        metrics: The metrics; None takes all.

    Raises:
        RunnerError: If a metric is none of the run's.
    """
    known = measure_run(run)
    samples = {
        name: summarize(known.values[name][0])._replace(undefined=_undefined(known, name, [0]))
        for name in known.named(metrics)
    }
    notes = _of_numbers([[sample] for sample in samples.values()], [1])
    if run.status != "ok":
        notes.append(f"The run {run.failure}.")
    if run.caveats:
        notes.append(f"Caveats: {', '.join(str(caveat['rule']) for caveat in run.caveats)}.")
    sources = [f"From: {run.provenance['command']}", f"Commit: {run.provenance['commit']}"]
    cells: list[list[Cell]] = [[title(name), known.units[name], sample.median] for name, sample in samples.items()]
    return PaperTable(Table("", ["metric", Column("unit", "unit"), *numbers("")], cells), notes, sources)


def _undefined(measurements: Measurements, name: str, cells: Sequence[int] | NDArray[np.intp]) -> int:
    """Return the number of repetitions of some cells whose runs do not define a metric."""
    mask = measurements.undefined.get(name)
    return 0 if mask is None else int(mask[cells].sum())


def _of_numbers(samples: Sequence[Sequence[Sample]], seeds: Sequence[int]) -> list[str]:
    cells = [sample for row in samples for sample in row]
    counts = {cell.n for cell in cells if cell.n} or {0}  # a metric that the runs do not define has no n
    notes = []
    if any(cell.median.low is not None for cell in cells):
        notes.append(
            f"Median, and in brackets its 95 % interval: percentile bootstrap of {RESAMPLES} resamples, percentiles "
            "expanded for small samples."
        )
    else:
        notes.append("Medians.")
    if any(cell.n >= SMALLEST_SAMPLE and cell.median.low is None for cell in cells):
        notes.append("No interval is given if its ends are the same because most repetitions gave the same value.")
    if min(counts, default=SMALLEST_SAMPLE) < SMALLEST_SAMPLE:
        notes.append(f"No interval is given if n is below {SMALLEST_SAMPLE}: so few values allow none at 95 %.")
    of_seeds = {count for count in seeds if count > 1}
    if len(counts) == 1:
        over = f" from {seeds[0]} seeds" if of_seeds and len(set(seeds)) == 1 else ""
        notes.append(f"n = {counts.pop()} repetitions{over} behind each median.")
    else:
        notes.append("n counts the repetitions behind a median.")
    lost = sum(cell.lost for cell in cells)
    undefined = sum(cell.undefined for cell in cells)
    every = undefined + sum(cell.n for cell in cells)
    reasons = [
        (lost, "as a repetition failed or never got there; they count as beyond every number (∞)"),
        (undefined, "as the runs do not define their metric (–)"),
    ]
    notes += [f"{count} of {every} values are missing, {reason}." for count, reason in reasons if count]
    if any(cell.median.is_rounding for cell in cells):
        notes.append(f"0 stands for what is below {ROUNDING:g} in SI units: rounding of the arithmetic.")
    return notes


def _of_cells(measurements: Measurements, pooled: Pooled) -> list[str]:
    """Return the notes on the cells: failures, caveats, and differences beyond the axes."""
    cells = [int(cell) for own in pooled.cells for cell in own]
    notes = []
    failed = sum(pooled.failed)
    if failed:
        notes.append(f"{failed} of {len(cells)} cells failed.")
    doubted = [cell for cell in cells if measurements.caveats and measurements.caveats[cell]]
    if doubted:
        rules = dict.fromkeys(str(caveat["rule"]) for cell in doubted for caveat in measurements.caveats[cell])
        notes.append(f"{len(doubted)} of {len(cells)} cells have caveats: {', '.join(rules)}.")
    differing = in_words(measurements.differences)
    if differing:
        notes.append(f"In the whole sweep {differing}.")
    return notes
