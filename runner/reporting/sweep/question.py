"""Paired comparisons of the values of an axis: the main question of a sweep, and the tables of all axes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.quantities import quantity
from runner.reporting.answers import EXPLAINED, HEADER, Answer, ask, judge
from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.comparison.pairs import SEED, Pairs, label_text, level_pairs
from runner.reporting.document import Block, Section, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import capital, first_screen, title
from runner.reporting.sweep.subject import Subject
from runner.statistics import SMALLEST_SAMPLE
from runner.store.axes import Axis

_MOST_TOLD = 3  # pairs of values of an axis, and keys that go with it, that sentences tell
_MOST_PAIRS = 24


@dataclass(frozen=True)
class Question:
    """How the values of one axis compare in the metrics of the first screen.

    Attributes:
        axis: The axis that is asked about.
        within: The other axis at each of whose values it is asked again; empty if nothing else was swept.
        overall: Each pair of values, over all else.
        at: Each pair of values at one value of the other axis.
        answers: The answers for all of these pairs.
    """

    axis: str
    within: str
    overall: Sequence[Pairs]
    at: Sequence[Pairs]
    answers: Sequence[Answer]

    def about(self, pairs: Pairs) -> list[Answer]:
        """Return the answers for one pair of values."""
        return [answer for answer in self.answers if answer.pairs is pairs]


def find_question(subject: Subject) -> Question | None:
    """Return what a sweep asks and the answers; None where no two cells differ in one axis and share their seeds.

    Asked about is the first axis whose values are choices, such as controllers, else the first one. Its values are
    compared with its first one: over all else, a value for each draw; and at each value of the axis, of the others,
    over whose values the medians of the first metric spread most.
    """
    axes = [axis for axis in subject.axes if axis.name != SEED]
    if not subject.metrics or not axes:
        return None
    axis, *others = sorted(axes, key=lambda each: each.numbers is not None)
    measurements, metrics = subject.measurements, first_screen(subject.metrics)
    overall = level_pairs(measurements, axis.name, ())
    within = max(others, key=lambda each: _spread(subject, each)).name if others else ""
    at = level_pairs(measurements, axis.name, [within]) if within else []
    found = judge(ask([*overall, *at], metrics), metrics)
    return Question(axis.name, within, overall, at, found) if found else None


def sentences(question: Question, subject: Subject) -> list[str]:
    """Return the answers in words, with where values of the other axis tell more and what else may be the cause."""
    told = []
    for pairs in question.overall[:_MOST_TOLD]:
        told += [answer.sentence(_at(question, answer)) for answer in question.about(pairs)]
    left = len(question.overall) - _MOST_TOLD
    if left > 0:
        told.append(f"{left} more values of {question.axis} are in the tables of pairs.")
    along = [found.key for found in subject.measurements.differences if question.axis in found.axes]
    if along and any(answer.sign for answer in question.answers):
        more = f" and {len(along) - _MOST_TOLD} more" if len(along) > _MOST_TOLD else ""
        named = f"{', '.join(along[:_MOST_TOLD])}{more}"
        told.append(f"With {question.axis} go {named}, which may be the cause: see Also differs.")
    return told


def in_short(subject: Subject) -> str:
    """Return the first answer, as a command that made a sweep ends with it; else the range of medians, and why."""
    few = too_few(subject)
    question = None if few else find_question(subject)
    if question is not None and len(question.overall) == 1:
        first, *_ = question.about(question.overall[0])
        return first.sentence(_at(question, first))
    found = range_told(subject)
    return f"{found[0]}: medians from {found[1]}. {few}".rstrip() if found else ""


def range_told(subject: Subject) -> tuple[str, str] | None:
    """Return the first metric and the range of its medians over the cells, in words; None where nothing is ranked."""
    if not (subject.ranked and subject.axes):
        return None
    metric = subject.metrics[0]
    ends = [float(subject.medians[metric][cell]) for cell in (subject.ranked[0], subject.ranked[-1])]
    low, high = (quantity(end, subject.measurements.units[metric]) for end in ends)
    return title(metric), f"{low} to {high}"


def too_few(subject: Subject) -> str:
    """Return that a sweep has too few draws for any difference to be shown; empty where it has enough."""
    draws = np.unique(subject.measurements.draws).size
    if draws >= SMALLEST_SAMPLE:
        return ""
    return (
        f"With {draws} pair{'s' if draws > 1 else ''} no difference can be shown: {SMALLEST_SAMPLE} are the fewest, as "
        f"by repetitions={SMALLEST_SAMPLE}."
    )


def _at(question: Question, overall: Answer) -> str:
    """Return at which values of the other axis the same two values of the axis differ; empty if at none."""
    same = [pairs for pairs in question.at if (pairs.first, pairs.second) == overall.names]
    found = [answer for answer in question.answers
             if answer.pairs in same and answer.metric == overall.metric and answer.sign]  # fmt: skip
    if not found:
        return ""
    told = ", ".join(f"{answer.word} by {answer.amount} at {label_text(answer.at)}" for answer in found)
    rest = len(same) - len(found)
    others = f"; at {rest} other value{'s' if rest > 1 else ''} no difference is shown" if rest else ""
    return f" {overall.names[1]} is {told}{others}."


def _spread(subject: Subject, axis: Axis) -> float:
    """Return the variance of the first metric between the values of an axis, over the medians of their cells."""
    medians = subject.medians[subject.metrics[0]]
    finite = np.isfinite(medians)
    means = [medians[finite & (axis.level == level)] for level in np.unique(axis.level)]
    return float(np.var([some.mean() for some in means if some.size])) if finite.any() else 0.0


def pairs_section(subject: Subject) -> Section | None:
    """Return the comparisons of each metric, axis by axis; None where no two cells share their seeds."""
    # Choices, such as controllers, are what is compared most.
    axes = sorted(subject.axes, key=lambda axis: axis.numbers is not None)
    tables: dict[str, list[Block]] = {metric: [] for metric in subject.metrics}
    for axis in axes:
        within = level_pairs(subject.measurements, axis.name)
        overall = level_pairs(subject.measurements, axis.name, ()) if any(pair.at for pair in within) else []
        chosen = [within[place] for place in spaced_indices(len(within), _MOST_PAIRS)]
        fewer = (
            f" ({len(chosen)} of {len(within)} pairs, spread evenly over the sweep)"
            if len(chosen) < len(within)
            else ""
        )
        found = judge(ask([*overall, *chosen], subject.metrics), first_screen(subject.metrics))
        for metric, blocks in tables.items():
            rows = [_row(answer) for answer in found if answer.metric == metric]
            if rows:
                blocks.append(_table(subject, axis, metric, rows, bool(overall), fewer))
    sections = [Section(capital(title(metric)), blocks) for metric, blocks in tables.items() if blocks]
    if not sections:
        return None
    text = (
        "The cells of a pair differ in one axis alone, and in what goes with it (Also differs). "
        f"{EXPLAINED} The option --metrics compares by other metrics."
    )
    return Section("Compared in pairs", [Text(text)], sections)


def _table(
    subject: Subject, axis: Axis, metric: str, rows: Sequence[Sequence[str]], overall: bool, fewer: str
) -> Table:
    within = "over all other axes and within each level of them" if overall else "as the only axis"
    if any(other.name == SEED for other in subject.axes):
        within += ", over all seeds"
    return Table(
        literal(f"{capital(title(metric))} by {axis.name}, {within}{fewer}."),
        ["at", literal(axis.name), *HEADER, "the second is"],
        rows,
        tuple(range(2, 2 + len(HEADER))),
    )


def _row(answer: Answer) -> Sequence[str]:
    at = ", ".join(f"{name}={text}" for name, text in answer.at.items()) or "all"
    return [*literals([at, ", ".join(answer.names)]), *answer.cells]
