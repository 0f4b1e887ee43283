"""Report on several sweeps: config differences, matched cells and paired metrics."""

from collections.abc import Sequence

from runner.reporting.comparison.figures import blocks, table_blocks
from runner.reporting.comparison.sweeps import (
    NOISE_ALONE,
    SweepComparison,
    compare_sweeps,
    format_count,
    size_told,
)
from runner.reporting.document import Block, Code, Document, Items, Notice, Provenance, Section, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import key_label, shorten
from runner.sweeps.measurements import Measurements

_MOST_ROWS = 40


def comparison_document(sides: Sequence[Measurements], wanted: Sequence[str] = ()) -> Document:
    """Return the report on several stored sweeps, the first of which the others are compared with.

    Args:
        sides: The sweeps, two or more.
        wanted: Metrics that are compared, the first of which the key numbers tell; empty for all.

    Raises:
        RunnerError: If two share no cell, no seed or no metric, or have no such metric.
    """
    found = [compare_sweeps(sides[0], side, wanted) for side in sides[1:]]
    if len(found) == 1:
        compared = _sections(found[0], wanted)
    else:
        compared = [
            Section(f"{one.pairs.second} against {one.pairs.first}", (), _sections(one, wanted)) for one in found
        ]
    return Document(
        title=f"{len(sides)} sweeps compared",
        subtitle=literal(", ".join(f"{side.name}: {side.folder.resolve().name}" for side in sides)),
        abstract=literal(" ".join(_abstract(found))),
        sections=[_sides(sides), *compared, _caveats(sides), _made(sides)],
        date=max(max(side.provenance["made on"]) for side in sides),
        key_numbers=_key_numbers(found[0]),
        figures_float=False,
    )


def _abstract(found: Sequence[SweepComparison]) -> list[str]:
    told = [one.differences.in_words(one.pairs.first, one.pairs.second) for one in found]
    told += [answer.sentence() for one in found for answer in one.headlines]
    return [*told, *([NOISE_ALONE] if any(one.noise_alone for one in found) else [])]


def _key_numbers(found: SweepComparison) -> list[tuple[str, str, str]]:
    """Return how many cells match, what differs, how many metrics do, and the difference in the first one."""
    a, b = found.pairs.first, found.pairs.second
    alone = ", ".join(
        f"{len(some)} in {name} alone" for name, some in zip((a, b), found.pairs.alone, strict=True) if some
    )
    numbers = [("cells in both", str(len(found.pairs)), alone)]
    names = found.differences.names
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    numbers.append((f"{a} and {b} differ in", format_count(len(names), "value", "values"), "".join([*names[:1], more])))
    first = min(found.answers, key=lambda answer: answer.rank)
    difference, interval, n, *_ = first.cells
    return [*numbers, (f"{title(first.metric)}, {b} - {a}", difference, f"{interval}, {n} pairs: {first.word}")]


def _sides(sides: Sequence[Measurements]) -> Section:
    rows = [literals([side.name, side.folder.resolve().name, ", ".join(side.fixed), size_told(side)])
            for side in sides]  # fmt: skip
    return Section("The sweeps", (Table("What is compared.", ["name", "sweep", "fixed", "cells"], rows),))


def _sections(found: SweepComparison, wanted: Sequence[str]) -> list[Section]:
    told = literal(found.differences.in_words(found.pairs.first, found.pairs.second))
    first: Block = (
        Text(told) if len(found.differences.names) < 2 else Notice("warning", "More than one thing differs", told)
    )
    cells = Items([literal(text) for text in found.cells_told()])
    return [
        Section("What differs", [first, *_difference_tables(found), cells]),
        Section("Cell by cell", blocks(found, wanted)),
        Section("Every metric", table_blocks(found, wanted)),
    ]


def _caveats(sides: Sequence[Measurements]) -> Section:
    rows = [
        literals([side.name, rule, f"{count} of {len(side.hashes)}", text])
        for side in sides
        for rule, count, _, text in side.caveats_by_rule()
    ]
    if not rows:
        return Section("Caveats", (Text("No rule found anything."),))
    caption = "Why results may not be what they seem: rules, cells with that caveat, and the worst of them."
    return Section("Caveats", (Table(caption, ["sweep", "caveat", "cells", "what was found"], rows, (2,)),))


def _made(sides: Sequence[Measurements]) -> Section:
    blocks: list[Block] = []
    for side in sides:
        blocks += [Text(f"{side.name} is made by"), Code(side.command)]
    rows = []
    for name in dict.fromkeys(name for side in sides for name in side.provenance):
        texts = {side.name: ", ".join(side.provenance.get(name, ["–"])) for side in sides}
        same = len(set(texts.values())) == 1
        rows += [(name, texts[sides[0].name])] if same else [(f"{name}, {side}", text) for side, text in texts.items()]
    return Section("Provenance", [*blocks, Provenance(rows)])


def _difference_tables(found: SweepComparison) -> list[Block]:
    """Return the resolved values that differ, and what made the runs where that differs."""
    a, b = found.pairs.first, found.pairs.second
    values = [*found.differences.options, *found.differences.values]
    blocks: list[Block] = []
    if values:
        left = len(values) - _MOST_ROWS
        more = f" {left} more differ." if left > 0 else ""
        caption = f"All resolved values that differ in the cells that both have.{more}"
        rows = [
            literals([key_label(value.key), shorten(value.a), shorten(value.b), value.cells or "all cells"])
            for value in values[:_MOST_ROWS]
        ]
        blocks.append(Table(caption, ["key", a, b, "at"], rows))
    if found.differences.provenance:
        rows = [literals([value.key, value.a, value.b]) for value in found.differences.provenance]
        blocks.append(Table("They were made by different versions.", ["made by", a, b], rows))
    return blocks
