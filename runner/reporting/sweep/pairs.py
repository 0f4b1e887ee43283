"""Paired comparisons of the values of one axis, pooled and for each combination of the other axes."""

from collections.abc import Sequence

from runner.reporting.answers import EXPLAINED, HEADER, Answer, Asked, judge
from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.comparison.levels import SEED, LevelPair, level_pairs
from runner.reporting.comparison.pairs import compare
from runner.reporting.document import Block, Section, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import Subject, first_screen
from runner.sweeps.measurements import Axis

_MOST_ROWS = 24


def section(subject: Subject) -> Section | None:
    """Return the comparisons of each metric, axis by axis; None where no two cells share their seeds."""
    # Choices, such as controllers, are what is compared most.
    axes = sorted(subject.axes, key=lambda axis: axis.numbers is not None)
    tables: dict[str, list[Block]] = {metric: [] for metric in subject.metrics}
    for axis in axes:
        within = level_pairs(subject.measurements, axis.name)
        overall = level_pairs(subject.measurements, axis.name, ()) if any(pair.at for pair in within) else []
        chosen = [within[place] for place in spaced_indices(len(within), _MOST_ROWS)]
        fewer = (
            f" ({len(chosen)} of {len(within)} pairs, spread evenly over the sweep)"
            if len(chosen) < len(within)
            else ""
        )
        found = _answers(subject, [*overall, *chosen])
        for metric, blocks in tables.items():
            rows = [_row(pair, answer) for pair, answer in found if answer.metric == metric]
            if rows:
                blocks.append(_table(subject, axis, metric, rows, bool(overall), fewer))
    sections = [Section(_capital(title(metric)), blocks) for metric, blocks in tables.items() if blocks]
    if not sections:
        return None
    text = (
        "The cells of a pair differ in one axis alone, and in what goes with it (Also differs). "
        f"{EXPLAINED} The option --metrics compares by other metrics."
    )
    return Section("Compared in pairs", [Text(text)], sections)


def _answers(subject: Subject, pairs: Sequence[LevelPair]) -> list[tuple[LevelPair, Answer]]:
    measurements = subject.measurements
    compared = [
        (pair, Asked(metric, measurements.units[metric], found))
        for metric in subject.metrics
        for pair in pairs
        if (found := compare(measurements, measurements, metric, pair.cells))
    ]
    answers = judge([asked for _, asked in compared], first_screen(subject.metrics))
    return [(pair, answer) for (pair, _), answer in zip(compared, answers, strict=True)]


def _table(
    subject: Subject, axis: Axis, metric: str, rows: Sequence[Sequence[str]], overall: bool, fewer: str
) -> Table:
    within = "over all other axes and within each level of them" if overall else "as the only axis"
    if any(other.name == SEED for other in subject.axes):
        within += ", over all seeds"
    return Table(
        literal(f"{_capital(title(metric))} by {axis.name}, {within}{fewer}."),
        ["at", literal(axis.name), *HEADER, "the second is"],
        rows,
        tuple(range(2, 2 + len(HEADER))),
    )


def _row(pair: LevelPair, answer: Answer) -> Sequence[str]:
    at = ", ".join(f"{name}={text}" for name, text in pair.at.items()) or "all"
    return [*literals([at, f"{pair.first}, {pair.second}"]), *answer.cells]


def _capital(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"
