"""Report blocks of a spec: bounds, pass rates and confidence."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from runner.reporting.document import Block, Notice, Table
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.spec_words import HEADER, interval_text, lacking_text, late_text, probability, spec_rows
from runner.store import Run

if TYPE_CHECKING:
    from runner.statistics.spec import Spec

RULE = (
    "The interval is that of Clopper and Pearson: it holds the true probability in 95 % of cases or more. A repetition "
    "that failed, or has no value, as it never settled, does not keep its bound."
)
_NUMERIC = (1, 2, 3)  # columns


def spec_blocks(run: Run) -> list[Block]:
    """Return the bounds of a run's spec, with their reasons, and a notice where the run lacks one of the metrics."""
    if run.spec is None:
        return []
    rows, header = [[*row] for row in spec_rows(run.spec)], [*HEADER]
    reasons = [one.bound.reason for one in run.spec.bounds]
    if any(reasons):
        rows = [[*row, reason] for row, reason in zip(rows, [*reasons, ""], strict=False)]
        header.append("reason")
    table = Table(f"Bounds of the spec. {RULE}", header, [literals(row) for row in rows], _NUMERIC)
    lacking = lacking_text(run.spec, run.metrics)
    if not lacking:
        return [table]
    return [Notice("warning", "The run lacks a metric of its spec", literal(f"{lacking}.")), table]


def spec_abstract(spec: "Spec") -> str:
    """Return in a sentence how often the whole spec is kept."""
    if spec.whole is None:
        return "The run lacks a metric of its spec."
    failing, several = spec.whole.rest, len(spec.bounds) > 1
    what = f"all {len(spec.bounds)} bounds" if several else "the bound"
    late = [title(one.metric) for one in spec.bounds if late_text(one.metric, one.bound, one.history)]
    return (
        f"{spec.whole.kept} of {spec.whole.of} repetitions keep {what} of the spec: the probability of failing is "
        f"{probability(failing.share)} (95 % interval {interval_text(failing)})."
        + (f" Set after the result was known: {', '.join(late)}." if late else "")
    )


def spec_of_several(runs: Sequence[Run]) -> list[Block]:
    """Return how often each of several runs keeps each bound of its spec, where any has one."""
    rows = [
        literals([str(number), *row])
        for number, run in enumerate(runs, start=1)
        if run.spec is not None
        for row in spec_rows(run.spec)
    ]
    numeric = tuple(column + 1 for column in _NUMERIC)
    return [Table(f"Bounds of the specs. {RULE}", ["run", *HEADER], rows, numeric)] if rows else []
