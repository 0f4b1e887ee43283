"""All that a sweep measured, cell by cell: swept axes, status, and every metric in every repetition."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.caveats import changes_since
from runner.store import Run
from runner.sweeps.differing import Difference, Resolved
from runner.sweeps.resolved import Resolver
from runner.sweeps.swept import is_simulated

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Axis:
    """A key whose value differs between the cells of a sweep.

    Attributes:
        name: The key, such as "noise.position", or a group, such as "controller".
        values: Its distinct values: numbers in ascending order; texts, as first met, where not all are numbers.
        level: Index into `values` of each cell, shape (cells,).
    """

    name: str
    values: Sequence[float] | Sequence[str]
    level: NDArray[np.intp]

    @property
    def numbers(self) -> FloatArray | None:
        """Its values as numbers, shape (levels,), or None where they are texts."""
        return None if any(isinstance(value, str) for value in self.values) else np.array(self.values, dtype=float)


@dataclass(frozen=True)
class Measurements:
    """The cells of a sweep, in the order of its jobs.

    Attributes:
        axes: What was swept.
        fixed: Overrides that all cells share, as typed.
        hashes: Name of each cell's run.
        statuses: "ok" or "failed".
        failures: When, where and why a cell failed, in words; empty for a good one.
        units: Unit of each metric.
        values: Each metric in each repetition, shape (cells, repetitions): infinite, that is beyond every number,
            where the repetition failed or never settled; NaN where the run has no such metric or repetition.
        provenance: What made the runs: plant, commit, machine, date and so on, each with its distinct values.
        caveats: Why the result of each cell may not be what it seems, as stored: rule, text, value, repetitions.
        caveat_changes: With what else than today these were looked for, each with the number of cells.
        seeds: Seed of each cell; empty where all have the same.
        differences: Resolved config values that differ between cells beyond the axes.
    """

    axes: Sequence[Axis]
    fixed: Sequence[str]
    hashes: Sequence[str]
    statuses: Sequence[str]
    failures: Sequence[str]
    units: Mapping[str, str]
    values: Mapping[str, FloatArray]
    provenance: Mapping[str, Sequence[str]]
    caveats: Sequence[Sequence[Mapping[str, Any]]] = ()
    caveat_changes: Mapping[str, int] = field(default_factory=dict)
    seeds: Sequence[int] = ()
    differences: Sequence[Difference] = ()

    @property
    def draws(self) -> NDArray[np.intp]:
        """Number of the random draws behind each value, shape (cells, repetitions).

        Equal for the same repetition of cells of one seed, and different else.
        """
        seeds = np.unique(self.seeds, return_inverse=True)[1] if len(self.seeds) else np.zeros(len(self.hashes), int)
        return seeds[:, None] * self.repetitions + np.arange(self.repetitions)

    @property
    def repetitions(self) -> int:
        """The most repetitions that a cell has."""
        return max((values.shape[1] for values in self.values.values()), default=1)

    def of_cell(self, metric: str, cell: int) -> FloatArray:
        """Return the values of a metric over the repetitions of one cell, shape (n,)."""
        row = self.values[metric][cell]
        values: FloatArray = row[~np.isnan(row)]
        return values

    def medians(self, metric: str) -> FloatArray:
        """Return the median of a metric in each cell, shape (cells,): infinite or NaN as its values."""
        ordered = np.sort(self.values[metric], axis=1)  # NaN, which is no repetition, comes last
        count = np.sum(~np.isnan(ordered), axis=1)
        cells = np.arange(len(ordered))
        low, high = ordered[cells, np.maximum(count - 1, 0) // 2], ordered[cells, count // 2]
        medians: FloatArray = (low + high) / 2
        return medians


def measure(overrides: Sequence[Sequence[str]], runs: Iterable[Run]) -> Measurements:
    """Read the runs of a sweep, one at a time.

    Args:
        overrides: Overrides of each job, as typed.
        runs: The run of each job.

    Raises:
        StoreError: If a run is missing or damaged.
    """
    hashes: list[str] = []
    statuses: list[str] = []
    failures: list[str] = []
    units: dict[str, str] = {}
    provenance: dict[str, dict[str, None]] = {}
    rows: list[Mapping[str, FloatArray]] = []
    caveats: list[Sequence[Mapping[str, Any]]] = []
    changes: Counter[str] = Counter()
    seeds: list[int] = []
    resolver, resolved = Resolver(), Resolved()
    for run, given in zip(runs, overrides, strict=True):
        resolved.add(resolver.resolve(run), given)
        seeds.append(int(run.provenance["seed"]))
        hashes.append(run.hash)
        statuses.append(run.status)
        failures.append(run.failure_text)
        units |= {name: str(metric["unit"]) for name, metric in run.metrics.items()}
        rows.append(_values(run))
        caveats.append(run.caveats)
        changes.update(changes_since(run.caveat_rules))
        for key, text in _made_by(run):
            provenance.setdefault(key, {})[text] = None
    axes, fixed = axes_of(overrides)
    width = max((len(values) for row in rows for values in row.values()), default=1)
    values = {name: np.full((len(rows), width), np.nan) for name in units}
    for cell, row in enumerate(rows):
        # A run of which no repetition ended stores no metric at all.
        lost = {} if row or statuses[cell] == "ok" else {name: np.full(width, np.inf) for name in units}
        for name, found in (row or lost).items():
            values[name][cell, : len(found)] = found
    made_by = {key: sorted(texts) for key, texts in provenance.items()}
    return Measurements(
        axes,
        fixed,
        hashes,
        statuses,
        failures,
        units,
        values,
        made_by,
        caveats,
        changes,
        seeds,
        resolved.differences(axes),
    )


def _made_by(run: Run) -> Iterator[tuple[str, str]]:
    record = run.provenance
    yield "plant", f"{run.config['plant']['kind']}, step {record['plant_step']:g} s"
    yield "commit", str(record["commit"] or "none (installed package)")
    yield "seed", str(record["seed"])
    yield "machine", str(record["machine"])
    yield from ((name, str(version)) for name, version in record["versions"].items())
    yield "made on", str(record["date"])
    if not run.sealed:
        yield "unsealed", "runs without digests: damage to them is not found"


def _values(run: Run) -> dict[str, FloatArray]:
    return {
        name: np.array([np.inf if value is None else value for value in metric["values"]], dtype=float)
        for name, metric in run.metrics.items()
    }


def axes_of(overrides: Sequence[Sequence[str]]) -> tuple[list[Axis], list[str]]:
    """Return the keys whose values differ between jobs as axes, and the other overrides."""
    given = [dict(override.lstrip("+").partition("=")[::2] for override in job) for job in overrides]
    keys = list(dict.fromkeys(key for job in given for key in job if is_simulated(key)))
    axes, fixed = [], []
    for key in keys:
        texts = [job.get(key, "") for job in given]
        if len(set(texts)) == 1:
            fixed.append(f"{key}={texts[0]}")
            continue
        distinct = list(dict.fromkeys(texts))
        numbers = [_number(text) for text in distinct]
        if None not in numbers:
            values: Sequence[float] | Sequence[str] = sorted({number for number in numbers if number is not None})
            place = {text: values.index(number) for text, number in zip(distinct, numbers, strict=True)}
        else:
            values = [text.strip("'\"") for text in distinct]
            place = {text: index for index, text in enumerate(distinct)}
        axes.append(Axis(key, values, np.array([place[text] for text in texts], dtype=np.intp)))
    return axes, fixed


def _number(text: str) -> float | None:
    """Return the value of an override where it is a finite number."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if np.isfinite(number) else None
