"""Spec in a report and on the command line: bounds, pass rates and confidence."""

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from runner.base.errors import nearest
from runner.base.quantities import format_range, number, quantity
from runner.plugins.metric_units import unit_of
from runner.reporting.document import Notice, ReportBlock, Table
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title
from runner.reporting.table import numbers
from runner.schema.bound import Bound, Range
from runner.statistics.spec import History, ends_of, set_after
from runner.store import Run

if TYPE_CHECKING:
    from runner.statistics.proportion import Share
    from runner.statistics.spec import Spec

RULE = (
    "The interval is that of Clopper and Pearson: it holds the true probability in 95 % of cases or more. A repetition "
    "that failed, or has no value, as it never settled, does not keep its bound."
)
COLUMNS = ("bound", *numbers("kept", "probability of failing", "95 % interval"))
"""Columns of the rows of `spec_rows`."""
_ALL = "all of them"
_DIGITS = 6  # of a bound, which is given, not measured


def spec_blocks(run: Run) -> list[ReportBlock]:
    """Return the bounds of a run's spec, with their reasons, and a notice where the run lacks one of the metrics."""
    if run.spec is None:
        return []
    rows, header = [[*row] for row in spec_rows(run.spec, run)], [*COLUMNS]
    reasons = [one.bound.reason for one in run.spec.bounds]
    if any(reasons):
        rows = [[*row, reason] for row, reason in zip(rows, [*reasons, ""], strict=False)]
        header.append("reason")
    table = Table(f"Bounds of the spec. {RULE}", header, rows)
    lacking = lacking_text(run.spec, run.metrics)
    if not lacking:
        return [table]
    return [Notice("warning", "The run lacks a metric of its spec", literal(f"{lacking}.")), table]


def spec_abstract(spec: "Spec") -> str:
    """Return in a sentence how often the whole spec is kept."""
    if spec.whole is None:
        return "The run lacks a metric of its spec."
    failing, several = spec.whole.rest, len(spec.bounds) > 1
    within = interval_text(failing) if failing.exact else f"95 % interval {interval_text(failing)}"
    what = f"all {len(spec.bounds)} bounds" if several else "the bound"
    late = [title(one.metric) for one in spec.bounds if late_text(one.metric, one.bound, one.history)]
    return (
        f"{spec.whole.kept} of {spec.whole.of} repetitions keep {what} of the spec: the probability of failing is "
        f"{probability(failing.share)} ({within})."
        + (f" Set after the result was known: {', '.join(late)}." if late else "")
    )


def spec_of_several(runs: Sequence[Run], names: Sequence[str]) -> list[ReportBlock]:
    """Return the number of kept repetitions for each bound of the specs of several runs."""
    rows = [
        [name, *row]
        for name, run in zip(names, runs, strict=True)
        if run.spec is not None
        for row in spec_rows(run.spec, run)
    ]
    return [Table(f"Bounds of the specs. {RULE}", ["run", *COLUMNS], rows)] if rows else []


def spec_rows(spec: "Spec", run: Run | None = None) -> list[tuple[str, str, str, str]]:
    """Return a row of COLUMNS for each bound, and one for all where there are several.

    Args:
        spec: The bounds.
        run: The run, to say in how many repetitions a metric has no value; None says nothing of it.
    """
    rows = []
    for one in spec.bounds:
        without = without_value(run, one.metric) if run else ""
        said = bound_text(one.metric, one.bound) + late_text(one.metric, one.bound, one.history)
        rows.append((f"{said}: {without}" if without else said, *share_texts(one.share)))
    if len(rows) > 1:
        rows.append((_ALL, "–", "–", "–") if spec.whole is None else (_ALL, *share_texts(spec.whole)))
    return rows


def without_value(run: Run, metric: str) -> str:
    """Return in how many repetitions of a run a metric has no value; empty if it has one in each, or in no run."""
    if metric not in run.record["metrics"]:
        return ""
    lost = int(np.isnan(run.values(metric)).sum())
    return f"no value in {lost} of {run.repetitions} repetition{'s' if run.repetitions > 1 else ''}" if lost else ""


def bound_text(metric: str, bound: Bound) -> str:
    """Return the demand of a bound, such as "settling time at most 1.6 s"."""
    return f"{title(metric)} {_ends_text(metric, bound.min, bound.max)}"


def late_text(metric: str, bound: Bound, history: History) -> str:
    """Return, to be appended, that a bound was set after the result was known, and the former bound; else nothing."""
    date, before = set_after(history, ends_of(bound))
    told = ", then ".join(_ends_text(metric, *ends) for ends in before)
    return f", set after the result was known ({date}; before: {told})" if date else ""


def _ends_text(metric: str, low: float | None, high: float | None) -> str:
    unit = unit_of(metric) or "1"
    return Range.between(low, high).text(
        lambda end: quantity(end, unit, _DIGITS), lambda first, last: format_range(first, last, unit)
    )


def share_texts(share: "Share | None") -> tuple[str, str, str]:
    """Return the number of repetitions that keep a bound, the fraction of the others, and its interval."""
    if share is None:
        return "no such metric", "–", "–"
    failing = share.rest
    return f"{share.kept} of {share.of}", probability(failing.share), interval_text(failing)


def interval_text(share: "Share") -> str:
    """Return the ends of the interval of a probability; a word if nothing is drawn."""
    return "exact: nothing is drawn" if share.exact else f"{probability(share.low)} to {probability(share.high)}"


def probability(value: float) -> str:
    """Return a probability with three digits, below a thousandth with a power of ten."""
    return str(number(value, plain=1e-3))


def lacking_text(spec: "Spec", known: Collection[str]) -> str:
    """Return the metrics of its spec that a run lacks, with the nearest that it has; empty without one."""
    if not spec.lacking:
        return ""
    named = ", ".join(f"{metric}{nearest(metric, known)}" for metric in spec.lacking)
    return f"spec: the run has no {named}, so it cannot be judged by that; it has: {', '.join(known)}"
