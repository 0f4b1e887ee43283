"""Comparison of two sweeps or runs by cell and repetition, and of the levels of one sweep axis."""

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.base.quantities import ROUNDING
from runner.base.sanitize import few
from runner.reporting.answers import Answer, judge
from runner.reporting.asked import AskedComparison, ask
from runner.reporting.comparison.differences import ConfigDifferences, find_differences
from runner.reporting.comparison.pairs import Label, Pairs, keep_common_seeds, label_text, level_pairs, match
from runner.reporting.conditions import ALIKE, keep_described
from runner.reporting.metric_titles import first_screen, is_part
from runner.reporting.sweep.subject import main_metrics
from runner.statistics import SMALLEST_SAMPLE
from runner.store.drawn import draws_model
from runner.store.run import Run
from runner.store.sweep import Sweep
from runner.sweeps.measurements import Measurements, check_metrics, measure_run, measure_stored, stored_part

MOST_CONDITIONS = 1_000
"""Conditions up to which each is compared by itself; of more only the pooled comparison is made."""

MOST_MOVEMENTS = 12
"""Cells with the largest differences that are named."""

NOISE_ALONE = (
    "Repetitions draw only noise (mismatch.spread is 0): the intervals do not cover another arm or another model error."
)

POOLED = (
    "Over all cells each draw counts once, by the mean of its cells. This number is left out if a cell has "
    f"another answer, or if the medians of either side differ by more than a factor of {ALIKE:g} between cells."
)

FAILED = "a failed repetition counts as beyond every number; one that fails in both is in no pair and no median here"
_MOST_OF_ONE = 3  # cells with the largest differences in the same metric
_NAMED = 3  # cells without a partner that are named


@dataclass(frozen=True)
class SweepComparison:
    """Comparison of the second of two sweeps with the first.

    Attributes:
        pairs: Cells that are compared.
        differences: Config values that differ between these.
        answers: Each metric over all cells, unless that describes none of them, and in each cell.
        cells: The cells with the largest differences in a metric, relative to its size; the largest first.
        candidates: Number of cells and metrics that these were chosen from.
        wanted: Metrics that were asked for; empty for all.
    """

    pairs: Pairs
    differences: ConfigDifferences
    answers: Sequence[Answer]
    cells: Sequence[AskedComparison]
    candidates: int
    wanted: Sequence[str] = ()

    def cells_told(self) -> Iterator[str]:
        """Yield which cells are compared, and which are not and why."""
        pairs = self.pairs
        by = f", matched by {', '.join(pairs.keys)}" if pairs.keys else ""
        repetitions = min(side.repetitions for side in (pairs.a, pairs.b))
        both = format_count(len(pairs), "cell is", "cells are")
        yield f"{both} in both{by}; up to {repetitions} repetitions of each are compared"
        if pairs.other_seeds:
            more = format_count(pairs.other_seeds, "more cell is", "more cells are")
            yield f"{more} in both with different seeds, and not compared"
        for side, alone in zip((pairs.a, pairs.b), pairs.alone, strict=True):
            if alone:
                yield f"{format_count(len(alone), 'cell is', 'cells are')} only in {side.name}: {_some(alone)}"
            if side.missing:
                yield missing_cells_text(side)
            if side.failed:
                failed = format_count(side.failed, "cell", "cells")
                yield f"{failed} of {side.name} failed; {FAILED}"


def missing_cells_text(side: Measurements) -> str:
    """Return the number of cells that are not stored, the values that only these have, and the command for them."""
    of = f" of {side.name}" if side.name else ""
    cells = format_count(side.missing, f"cell{of} is", f"cells{of} are")
    without = f", so that none has {few(side.unseen, separator=' or ')}" if side.unseen else ""
    return f"{cells} not stored{without}; what follows holds for the others; continue with: {side.command}"


def measure_compared(things: Sequence[Run | Sweep]) -> list[Measurements]:
    """Read the runs or sweeps of a comparison, named A, B and so on.

    The effect of a finer step of the plant is computed first, if it is not stored.

    Raises:
        StoreError: If one cannot be read, or no cell of it is stored.
    """
    from runner.sweeps.finer_step import work_out, work_out_sweep

    sides = []
    for place, thing in enumerate(things):
        if isinstance(thing, Sweep):
            work_out_sweep(stored_part(thing)[0])
            sides.append(measure_stored(thing, letter(place)))
        else:
            work_out(thing.outputs, [thing])
            sides.append(measure_run(thing, letter(place)))
    return sides


def compare_sweeps(a: Measurements, b: Measurements, metrics: Sequence[str] = ()) -> SweepComparison:
    """Compare two sweeps, or two runs, in the cells and repetitions that both have.

    Args:
        a: The first, which the second is compared with.
        b: The second.
        metrics: Names of metrics; empty for the common ones.

    Raises:
        RunnerError: If they share no cell, no seed or no metric, or have no such metric.
    """
    pairs = keep_common_seeds(match(a, b))
    both = [name for name in a.values if name in b.values]
    if not both:
        raise RunnerError(f"{a.name} and {b.name} have no metric in common: all runs of one of them failed")
    check_metrics(metrics, both)
    names = list(dict.fromkeys(metrics)) or both
    cells, candidates = _movements(pairs, list(metrics) or [name for name in names if not is_part(name)])
    by_cell = list(pairs.each()) if 1 < len(pairs) <= MOST_CONDITIONS else []
    answers = answer([pairs, *by_cell], names, metrics)
    return SweepComparison(pairs, find_differences(pairs), answers, cells, candidates, metrics)


def compare_levels(
    measurements: Measurements, axis: str, within: Sequence[str] | None = None, metrics: Sequence[str] = ()
) -> list[Answer]:
    """Compare the levels of one axis of a sweep with each other in every metric, pooled and under each condition.

    A condition is a combination of the levels of all other axes but the seed. A pooled answer that does not describe
    its conditions is left out; see `keep_described`.

    Args:
        measurements: The sweep.
        axis: The axis, such as "controller".
        within: Axes within each combination of whose levels the comparison is made, with cells of the remaining axes
            pooled if that describes them; None for over all other axes and under each condition.
        metrics: Names of metrics; empty for all.

    Raises:
        RunnerError: If the sweep has no such axis or metric, or no two cells share their seeds.
    """
    check_metrics(metrics, measurements.values)
    pairs = level_pairs(measurements, axis, within or ())
    by_condition = [some for some in level_pairs(measurements, axis) if len(some.at) > len(within or ())]
    if len(by_condition) == len(pairs) == 1 and len(by_condition[0]) == len(pairs[0]):
        pairs = []  # the only condition with cells of both levels: it is named
    pairs += by_condition if len(by_condition) <= MOST_CONDITIONS else []
    if not pairs:
        raise RunnerError(
            f"{axis}: no two cells differ only in it and share their seed, so none are compared in pairs; sweep it "
            "with one seed, or over the same seeds for each value"
        )
    names = list(dict.fromkeys(metrics or measurements.values))
    return answer(pairs, names, metrics, whole=within is None)


def compare_runs(a: Measurements, b: Measurements, metrics: Sequence[str] = ()) -> tuple[list[Answer], str]:
    """Return the paired comparison of two runs on the same seeds, or none and the reason.

    Args:
        a: The first, which the second is compared with.
        b: The second.
        metrics: Names of metrics; empty for the main ones.
    """
    a, b = _with_lost(a, b), _with_lost(b, a)
    pairs = match(a, b)
    count = min(a.repetitions, b.repetitions)
    names = [name for name in metrics or main_metrics([a, b]) if name in a.values and name in b.values]
    if not pairs.share_seeds.all():
        return [], f"not compared in pairs: seed {a.seeds[0]} and seed {b.seeds[0]} share no noise"
    drawn = not (a.copies.all() and b.copies.all())
    if drawn and count < SMALLEST_SAMPLE:
        return [], f"not compared in pairs: {count} repetitions in common, and {SMALLEST_SAMPLE} are needed"
    if not names:
        return [], "not compared in pairs: no metric is in both"
    return answer([pairs], names, metrics), ""


def _with_lost(side: Measurements, other: Measurements) -> Measurements:
    """Return a run; one of which every repetition failed has the metrics of another, beyond every number."""
    if side.values or not side.failed:
        return side
    lost = {name: np.full((len(side.hashes), side.repetitions), np.inf) for name in other.values}
    return replace(side, values=lost, units=other.units)


def answer(
    pairs: Sequence[Pairs], names: Sequence[str], wanted: Sequence[str] = (), whole: bool = True
) -> list[Answer]:
    """Return the answers to one question, metric by metric.

    Args:
        pairs: What is compared.
        names: Metrics that are compared.
        wanted: Metrics that the user named, in order; empty to choose those of the first screen.
        whole: False to leave out conditions that a pooled answer describes.
    """
    asked = ask(pairs, names)
    known = {one.metric: None for one in asked}
    first = [name for name in wanted if name in known] or main_metrics([pairs[0].a, pairs[0].b], known)
    return keep_described(judge(asked, first_screen(first)), whole)


def answer_rows(answers: Sequence[Answer]) -> list[dict[str, Any]]:
    """Return a row for each answer: axes that are held ("all" for none), names, metric, numbers and verdict."""
    held = {name: "all" for one in answers for name in one.at}
    rows = []
    for one in answers:
        (first, second), (low, high) = one.names, one.interval or (None, None)
        found = one.comparison
        rows.append({
            **held, **one.at, "first": first, "second": second, "metric": one.metric, "unit": one.unit,
            "difference": found.difference, "low": low, "high": high, "n": found.n, "effect": found.effect,
            "p": one.p_value, "word": one.word,
        })  # fmt: skip
    return rows


def counts_by_sign(one: AskedComparison) -> tuple[int, int]:
    """Return the number of cells in which the median of the differences is below zero, and above zero."""
    if one.pairs is None:
        return 0, 0
    moved = _median_differences(one.pairs, one.metric)
    return int(np.sum(moved < -ROUNDING)), int(np.sum(moved > ROUNDING))


def noise_alone(sides: Sequence[Measurements]) -> bool:
    """Return True if the repetitions of sweeps or runs draw only noise: nothing of the arm is drawn from the seed."""
    several = min(side.repetitions for side in sides) > 1 and not all(side.copies.all() for side in sides)
    return several and not any(draws_model(config) for side in sides for config, _ in side.configs)


def letter(place: int) -> str:
    """Return the name of one of several folders: A, B, ..., Z, then its number."""
    return chr(ord("A") + place) if place < 26 else str(place + 1)


def format_count(count: int, one: str, many: str) -> str:
    """Return a number with what is counted, such as "1 cell is" or "2 cells are"."""
    return f"{count} {one if count == 1 else many}"


def size_told(side: Measurements) -> str:
    """Return the number of cells of a sweep, and of repetitions in each."""
    failed = f", {side.failed} of them failed" if side.failed else ""
    return f"{format_count(len(side.hashes), 'cell', 'cells')}{failed}; repetitions in each: {side.repetitions}"


def _some(labels: Sequence[Label]) -> str:
    more = f"; and {len(labels) - _NAMED} more" if len(labels) > _NAMED else ""
    return "; ".join(map(label_text, labels[:_NAMED])) + more


def _movements(pairs: Pairs, names: Sequence[str]) -> tuple[list[AskedComparison], int]:
    """Return the cells with the largest differences, and of how many in all metrics; none for a single cell."""
    if len(pairs) < 2:
        return [], 0
    sizes = [_relative(pairs, name) for name in names]
    moved = np.nan_to_num(np.array(sizes), nan=0.0, posinf=np.inf)
    cells = list(pairs.each())
    found: list[AskedComparison] = []
    for place in np.argsort(-moved, axis=None, kind="stable").tolist():
        metric, cell = divmod(place, len(pairs))
        if len(found) == MOST_MOVEMENTS or not moved[metric, cell]:
            break
        if sum(one.metric == names[metric] for one in found) < _MOST_OF_ONE:
            found += ask([cells[cell]], [names[metric]])
    return found, int(np.sum(~np.isnan(sizes)))


def _relative(pairs: Pairs, metric: str) -> FloatArray:
    """Return the size of the median of each pair's differences over the larger median; NaN without values."""
    a, b = pairs.a.values[metric][pairs.of_a], pairs.b.values[metric][pairs.of_b]
    moved = np.abs(_median_differences(pairs, metric))
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of cells without values
        largest = np.fmax(*(np.abs(np.nanmedian(some, axis=1)) for some in (a, b)))
    known = np.isfinite(largest) & (largest > ROUNDING)
    sizes = np.where(moved > ROUNDING, np.where(known, moved / np.where(known, largest, 1.0), np.inf), 0.0)
    return np.where(np.isnan(moved), np.nan, sizes)


def _median_differences(pairs: Pairs, metric: str) -> FloatArray:
    """Return the median of the differences of each pair of cells, shape (n,); NaN if no repetition has a value."""
    a, b = pairs.a.values[metric], pairs.b.values[metric]
    width = min(a.shape[1], b.shape[1])
    first, second = a[pairs.of_a, :width], b[pairs.of_b, :width]
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        found: FloatArray = np.nanmedian(second - first, axis=1)  # NaN where neither has a value
    return found
