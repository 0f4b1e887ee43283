"""Tables for publications: rows, medians with intervals, and notes."""

from collections.abc import Sequence
from dataclasses import dataclass

from runner.base.quantities import ROUNDING, SUPERSCRIPT, unit_text
from runner.reporting.export.columns import Column, Unit, column
from runner.reporting.export.pooling import Pooled, pool
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import choose, key_label
from runner.statistics import SMALLEST_SAMPLE
from runner.statistics.interval import RESAMPLES
from runner.store import Run
from runner.sweeps.differing import in_words
from runner.sweeps.measurements import Measurements, measure_run

Label = str | Unit


@dataclass(frozen=True)
class PaperTable:
    """A table for a paper.

    Attributes:
        heads: Titles of the first columns, such as the swept axes.
        labels: That of each row.
        columns: Medians with their intervals.
        notes: How the numbers were made, and what the reader must know of them, a sentence each.
        sources: Where they come from: command, commit.
    """

    heads: Sequence[str]
    labels: Sequence[Sequence[Label]]
    columns: Sequence[Column]
    notes: Sequence[str]
    sources: Sequence[str]

    @property
    def counts(self) -> Sequence[str]:
        """The number of values in each row; nothing if it is the same everywhere, because a note has it."""
        rows = [{each.cells[row].n for each in self.columns} for row in range(len(self.labels))]
        if len(set().union(*rows)) <= 1:
            return ()
        return [", ".join(map(str, sorted(counts))) for counts in rows]

    @property
    def lines(self) -> list[list[str]]:
        """The head and the rows as plain strings, a median with its interval as "4.1 [3.9, 4.4]"."""
        counts = self.counts
        lines = [[*self.heads, *map(_head, self.columns), *(["n"] if counts else [])]]
        for row, labels in enumerate(self.labels):
            cells = [each.cells[row] for each in self.columns]
            numbers = [f"{cell.median} [{cell.low}, {cell.high}]" if cell.low else cell.median for cell in cells]
            names = [unit_name(label) if isinstance(label, Unit) else label for label in labels]
            lines.append([*names, *numbers, *([counts[row]] if counts else [])])
        return lines


def _head(column: Column) -> str:
    unit = unit_name(column.unit)
    untitled = "median [95 % interval]" if column.has_intervals else "median"
    return f"{column.title} ({unit})" if unit else column.title or untitled


def unit_name(unit: Unit) -> str:
    """Return a unit as it is read, such as "10⁻⁶ N m"; nothing for 1."""
    power = f"10{str(unit.power).translate(SUPERSCRIPT)}" if unit.power else ""
    return f"{power} {unit_text(str(unit))}".strip()


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
    labels = [[axis.text(int(axis.level[row])) for axis in rows.axes] for row in range(len(rows.hashes))]
    columns = [column(title(name), rows.units[name], rows.values[name]) for name in names]
    notes = [*_of_numbers(columns, pooled.seeds), *_of_cells(measurements, pooled)]
    fixed = f"The same in all rows: {', '.join(rows.fixed)}." if rows.fixed else ""
    commits = [text for key, texts in rows.provenance.items() if key == "commit" for text in texts]
    return PaperTable(
        [key_label(axis.name) for axis in rows.axes],
        labels,
        columns,
        [*notes, *([fixed] if fixed else [])],
        [f"From: {command}", *(f"Commit: {commit}" for commit in commits)],
    )


def of_run(run: Run, metrics: Sequence[str] | None = None) -> PaperTable:
    """Return the table of one run: a row for each metric.

    Args:
        run: The run.
        metrics: The metrics; None takes all.

    Raises:
        RunnerError: If a metric is none of the run's.
    """
    known = measure_run(run)
    each = [column(title(name), known.units[name], known.values[name]) for name in known.named(metrics)]
    together = Column("", Unit("1"), [own.cells[0] for own in each])
    notes = _of_numbers([together], [1])
    if run.status != "ok":
        notes.append(f"The run {run.failure}.")
    if run.caveats:
        notes.append(f"Caveats: {', '.join(str(caveat['rule']) for caveat in run.caveats)}.")
    sources = [f"From: {run.provenance['command']}", f"Commit: {run.provenance['commit']}"]
    return PaperTable(["metric", "unit"], [[own.title, own.unit] for own in each], [together], notes, sources)


def _of_numbers(columns: Sequence[Column], seeds: Sequence[int]) -> list[str]:
    cells = [cell for each in columns for cell in each.cells]
    counts = {cell.n for cell in cells}
    notes = []
    if any(cell.low for cell in cells):
        notes.append(
            f"Median, and in brackets its 95 % interval: percentile bootstrap of {RESAMPLES} resamples, percentiles "
            "expanded for small samples."
        )
    else:
        notes.append("Medians.")
    if any(cell.alike for cell in cells):
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
    if lost:
        notes.append(
            f"{lost} of {sum(cell.n for cell in cells)} values are missing, as a repetition failed or never got "
            "there; they count as beyond every number (∞)."
        )
    if any(cell.rounding for cell in cells):
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
