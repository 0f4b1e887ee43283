"""Report on several sweeps: config differences, matched cells, and paired metrics as figures and tables."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runner.base.quantities import label_with_unit, quantity
from runner.base.sanitize import few, one_line
from runner.reporting.answer_map import make_map
from runner.reporting.answers import EXPLAINED, HEADER, PAIRS, Answer
from runner.reporting.asked import AskedComparison
from runner.reporting.challenge.beside import scope_line
from runner.reporting.comparison.difference_figure import difference_panel
from runner.reporting.comparison.pairs import Label, Pairs, label_text
from runner.reporting.comparison.sweeps import (
    NOISE_ALONE,
    POOLED,
    SweepComparison,
    compare_sweeps,
    counts_by_sign,
    format_count,
    noise_alone,
    size_told,
)
from runner.reporting.document import (
    Code,
    Curves,
    Document,
    Items,
    Notice,
    Panel,
    Provenance,
    ReportBlock,
    Section,
    Series,
    Table,
    Text,
)
from runner.reporting.markup import literal
from runner.reporting.metric_titles import capital, title, whole_metrics
from runner.reporting.sections import added_sections, make_sections
from runner.reporting.sentences import sentences, short_table
from runner.reporting.sweep.subject import MOST_METRICS, main_metrics, shorten, spans_decades
from runner.reporting.table import numbers
from runner.reporting.words import join_values
from runner.sweeps.differing import unit_of
from runner.sweeps.measurements import Measurements

_MOST_CHARACTERS = 36  # of the names of all cells below a panel
_MOST_CELLS = 24
"""Cells that are side by side; of more the medians are drawn against each other."""
_MOST_ROWS = 40  # of differing values


@dataclass(frozen=True)
class ComparisonSubject:
    """Sweeps or runs as the report on their comparison looks at them: the subject of the sections of the report.

    Attributes:
        sides: Two or more; the others are compared with the first.
        wanted: Metrics that are compared; empty for all.
    """

    sides: Sequence[Measurements]
    wanted: Sequence[str] = ()

    @cached_property
    def compared(self) -> list[SweepComparison]:
        """The comparison of each other side with the first; see compare_sweeps."""
        return [compare_sweeps(self.sides[0], side, self.wanted) for side in self.sides[1:]]


def comparison_document(sides: Sequence[Measurements], wanted: Sequence[str] = ()) -> Document:
    """Return the report on several stored sweeps; the others are compared with the first.

    Args:
        sides: The sweeps, two or more.
        wanted: Metrics that are compared, the first one is in the key numbers; empty for all.

    Raises:
        RunnerError: If two share no cell, no seed or no metric, or have no such metric.
    """
    subject = ComparisonSubject(sides, wanted)
    found = subject.compared
    by_pair = [(f"{one.pairs.second} against {one.pairs.first}", make_sections(OF_PAIR, one)) for one in found]
    compared = by_pair[0][1] if len(found) == 1 else [Section(name, (), own) for name, own in by_pair]
    details = make_sections(SECTIONS, subject)
    lines = [text for one in found for text in sentences(one.answers)[:1]]
    lines += [one.differences.in_words(one.pairs.first, one.pairs.second) for one in found]
    shared = [text for text in sides[0].fixed if all(text in side.fixed for side in sides)]
    lines += filter(None, [scope_line(found[0].answers, [side.folder for side in sides])])
    lines += [NOISE_ALONE] if any(noise_alone([one.pairs.a, one.pairs.b]) for one in found) else []
    return Document(
        title=(len(found) == 1 and found[0].differences.question("A", "B")) or f"{len(sides)} sweeps compared",
        subtitle=literal(", ".join(shared or [f"{side.name}: {side.folder.resolve().name}" for side in sides])),
        abstract=literal("\n".join(map(one_line, lines))),
        sections=[*compared, *added_sections("comparison", subject), *details],
        date=max(max(side.provenance["made on"]) for side in sides),
        key_numbers=_key_numbers(found[0]),
        map=make_map(found[0].answers) if len(found) == 1 else None,
    )


def _key_numbers(found: SweepComparison) -> list[tuple[str, str, str]]:
    """Return the numbers of matched cells and of differing keys, and the difference in the first metric."""
    a, b = found.pairs.first, found.pairs.second
    alone = ", ".join(
        f"{len(some)} only in {name}" for name, some in zip((a, b), found.pairs.alone, strict=True) if some
    )
    numbers = [("cells in both", str(len(found.pairs)), alone)]
    names = found.differences.names
    numbers.append((f"{a} and {b} differ in", format_count(len(names), "value", "values"), few(names, 1)))
    first = min(found.answers, key=lambda answer: answer.rank)
    if first.at:  # no pooled number describes the cells
        return numbers
    difference, interval, n, *_ = first.cells
    return [*numbers, (f"{title(first.metric)}, {b} - {a}", difference, f"{interval}, {n} pairs: {first.word}")]


def _sides(subject: ComparisonSubject) -> Section:
    rows = [[side.name, side.folder.resolve().name, ", ".join(side.fixed), size_told(side)] for side in subject.sides]
    return Section("The sweeps", (Table("What is compared.", ["name", "sweep", "fixed", "cells"], rows),))


def _answers(found: SweepComparison) -> Section:
    texts = sentences(found.answers)[1:]
    return Section("Answers", [*([Items(list(map(literal, texts)))] if texts else []), _main_table(found)])


def _what_differs(found: SweepComparison) -> Section:
    told = literal(found.differences.in_words(found.pairs.first, found.pairs.second))
    first: ReportBlock = (
        Text(told) if len(found.differences.names) < 2 else Notice("warning", "More than one thing differs", told)
    )
    cells = Items([literal(text) for text in found.cells_told()])
    return Section("What differs", [first, *_difference_tables(found), cells])


def _main_table(found: SweepComparison) -> Table:
    shown = _metrics(found, ())
    names = main_metrics([found.pairs.a, found.pairs.b], [one.metric for one in shown])
    return Table(literal(f"Each metric is a separate question. {PAIRS}"),
                 *short_table([one for one in found.answers if one.metric in names]))  # fmt: skip


def _caveats(subject: ComparisonSubject) -> Section:
    rows = [
        [side.name, rule, f"{count} of {len(side.hashes)}", text]
        for side in subject.sides
        for rule, count, _, text in side.caveats_by_rule()
    ]
    if not rows:
        return Section("Caveats", (Text("No rule found anything."),))
    caption = "Why results may not be what they seem: rules, cells with that caveat, and the worst of them."
    return Section("Caveats", (Table(caption, ["sweep", "caveat", *numbers("cells"), "what was found"], rows),))


def _made(subject: ComparisonSubject) -> Section:
    sides = subject.sides
    blocks: list[ReportBlock] = []
    for side in sides:
        blocks += [Text(f"{side.name} is made by"), Code(side.command)]
    rows = []
    for name in dict.fromkeys(name for side in sides for name in side.provenance):
        texts = {side.name: join_values(side.provenance.get(name, ["–"])) for side in sides}
        same = len(set(texts.values())) == 1
        rows += [(name, texts[sides[0].name])] if same else [(f"{name}, {side}", text) for side, text in texts.items()]
    return Section("Provenance", [*blocks, Provenance(rows)])


def _difference_tables(found: SweepComparison) -> list[ReportBlock]:
    """Return the resolved values that differ, and what made the runs where that differs."""
    a, b = found.pairs.first, found.pairs.second
    values = [*found.differences.options, *found.differences.values]
    blocks: list[ReportBlock] = []
    if values:
        left = len(values) - _MOST_ROWS
        more = f" {left} more differ." if left > 0 else ""
        caption = f"All resolved values that differ in the cells that both have.{more}"
        rows = [
            [
                label_with_unit(value.key, unit_of(value.key)),
                shorten(value.a),
                shorten(value.b),
                value.cells or "all cells",
            ]
            for value in values[:_MOST_ROWS]
        ]
        blocks.append(Table(caption, ["key", a, b, "at"], rows))
    if found.differences.provenance:
        rows = [[value.key, value.a, value.b] for value in found.differences.provenance]
        blocks.append(Table("They were made by different versions or machines.", ["made by", a, b], rows))
    return blocks


def _by_cell(found: SweepComparison) -> Section:
    """Return a figure of the first metrics that differ, or of the first ones."""
    names = list(dict.fromkeys(one.metric for one in found.answers))
    by_name = {one.metric: one for one in reversed(found.answers)}
    known = [by_name[name] for name in (found.wanted or whole_metrics(names)) if name in by_name]
    moved = [one for one in known if any(counts_by_sign(one))] or known
    pairs = found.pairs
    a, b = pairs.first, pairs.second
    many = len(pairs) > _MOST_CELLS
    panels = [_against(pairs, one.metric) if many else _differences(found, one.metric) for one in moved[:MOST_METRICS]]
    caption = (
        f"Median of each cell in {b} against that in {a}; on the line both are the same."
        if many
        else f"Difference {b} - {a} in each cell with its interval over the repetitions, if these are enough: each "
        "panel is a family of comparisons."
    )
    figure = Curves(literal(f"{caption} Points beyond every number are missing."), panels)
    return Section("Cell by cell", [figure] if many or not _numbered(pairs) else [figure, _cells(pairs)])


def _numbered(pairs: Pairs) -> bool:
    """Return True if the names of cells are too long for the place below a figure; numbers replace them then."""
    return sum(len(_name(label)) for label in pairs.labels) > _MOST_CHARACTERS


def _name(label: Label) -> str:
    return ", ".join(label.values()) or "the only cell"


def _cells(pairs: Pairs) -> Table:
    rows = [[str(number), *label.values()] for number, label in enumerate(pairs.labels, 1)]
    return Table("The cells of the figure.", [*numbers("cell"), *pairs.keys], rows)


def _differences(found: SweepComparison, metric: str) -> Panel:
    """Return the differences of each cell; numbers are below the columns if the names are too long."""
    pairs = found.pairs
    answers = [one for one in found.answers if one.metric == metric and (one.at or len(pairs) == 1)]
    numbered = _numbered(pairs)
    labels = [label_text(label) for label in pairs.labels]
    columns = [(str(labels.index(label_text(one.at)) + 1) if numbered else _name(one.at), one) for one in answers]
    return difference_panel(columns, "cell" if numbered or not pairs.keys else ", ".join(pairs.keys))


def _against(pairs: Pairs, metric: str) -> Panel:
    x, y = pairs.a.medians(metric)[pairs.of_a], pairs.b.medians(metric)[pairs.of_b]
    known = np.isfinite(x) & np.isfinite(y)
    both = np.concatenate([x[known], y[known]])
    log = spans_decades(both)
    ends = np.array([both.min(), both.max()]) if both.size else np.array([0.0, 1.0])
    hints = [label_text(label) for label, shown_ in zip(pairs.labels, known.tolist(), strict=True) if shown_]
    series = [
        Series("", ends, ends, "dotted", color=1),
        Series("", x[known], y[known], "points", color=0, hints=hints),
    ]
    across, up = (label_with_unit(side.name, pairs.a.units[metric]) for side in (pairs.a, pairs.b))
    return Panel(capital(title(metric)), across, up, series, log, log)


def _metrics(found: SweepComparison, wanted: Sequence[str]) -> list[Answer]:
    """Return the pooled answers in the metrics asked for, or in all but those of one direction or joint."""
    by_name = {one.metric: one for one in reversed(found.answers) if not one.at or len(found.pairs) == 1}
    return [by_name[name] for name in (wanted or whole_metrics(by_name)) if name in by_name]


def _every_metric(found: SweepComparison) -> Section:
    """Return the method, the table over all cells, and that of those with the largest differences."""
    a, b = found.pairs.first, found.pairs.second
    whole = _metrics(found, found.wanted)
    parts = [one for one in found.answers if one not in whole and (not one.at or len(found.pairs) == 1)]
    text = f"The difference is {b} - {a}. {EXPLAINED} {POOLED}"
    tables: list[ReportBlock] = [Text(text)]
    if whole:
        tables.append(_table("Every metric whose pooled number describes all cells.", found.pairs, whole))
    if parts:
        tables.append(_table("Metrics of one direction or joint.", found.pairs, parts, folded=True))
    if found.cells:
        caption = (
            "Largest differences in one cell, in relation to the size of the metric: chosen from "
            f"{found.candidates}, at most three of a metric; not tested."
        )
        rows = [[label_text(one.at), *_row(one), _median(one.comparison.difference, one.unit)] for one in found.cells]
        tables.append(Table(caption, ["cell", "metric", *numbers(a, b, "difference")], rows))
    return Section("Every metric", tables)


def _table(caption: str, pairs: Pairs, some: Sequence[Answer], folded: bool = False) -> Table:
    many = len(pairs) > 1
    more = ["cells below, above 0"] if many else []
    header = ["metric", *numbers(pairs.first, pairs.second, *HEADER), f"{pairs.second} is", *more]
    rows = [[*_row(one), *one.cells, *(["{}, {}".format(*counts_by_sign(one))] if many else [])] for one in some]
    return Table(caption, header, rows, folded=folded)


def _row(one: AskedComparison) -> list[str]:
    return [title(one.metric), *(_median(median, one.unit) for median in one.comparison.medians)]


def _median(value: float, unit: str) -> str:
    return quantity(value, unit) if math.isfinite(value) else "beyond every number"


OF_PAIR = (_answers, _what_differs, _by_cell, _every_metric)
"""Sections on each comparison with the first side: functions of it that return a section or None."""
SECTIONS = (_sides, _caveats, _made)
"""Sections on all sides: functions of the subject that return a section or None; plug-ins add theirs before them."""
