"""Report on several sweeps: config differences, matched cells and paired metrics."""

from collections.abc import Sequence

from runner.reporting.comparison.figures import answers, blocks, choose_metrics, table_blocks
from runner.reporting.comparison.messages import NOISE_ALONE, cells_told, format_count, size_told
from runner.reporting.comparison.operand import Side, caveats_of
from runner.reporting.comparison.sweeps import SweepComparison, compare_sweeps
from runner.reporting.document import Block, Code, Document, Items, Notice, Provenance, Section, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import first_screen, key_label, shorten

_MOST_ROWS = 40


def comparison_document(sides: Sequence[Side], wanted: Sequence[str] = ()) -> Document:
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
        compared = [Section(f"{one.b.name} against {one.a.name}", (), _sections(one, wanted)) for one in found]
    return Document(
        title=f"{len(sides)} sweeps compared",
        subtitle=literal(", ".join(f"{side.name}: {side.folder.resolve().name}" for side in sides)),
        abstract=literal(" ".join(_abstract(found, wanted))),
        sections=[_sides(sides), *compared, _caveats(sides), _made(sides)],
        date=max(max(side.measurements.provenance["made on"]) for side in sides),
        key_numbers=_key_numbers(found[0], wanted),
        figures_float=False,
    )


def _abstract(found: Sequence[SweepComparison], wanted: Sequence[str]) -> list[str]:
    noise = [NOISE_ALONE] if any(one.noise_alone for one in found) else []
    told = [one.beyond.in_words(one.a.name, one.b.name) for one in found]
    for one in found:
        judged = answers(one, wanted)
        first = first_screen([each.metric for each in choose_metrics(one, wanted)])
        told += [judged[name].sentence(one.a.name, one.b.name) for name in first]
    return [*told, *noise]


def _key_numbers(found: SweepComparison, wanted: Sequence[str]) -> list[tuple[str, str, str]]:
    """Return how many cells match, what differs, how many metrics do, and the difference in the first one."""
    a, b = found.a.name, found.b.name
    alone = ", ".join(
        f"{len(some)} in {name} alone" for name, some in zip((a, b), found.matched.alone, strict=True) if some
    )
    numbers = [("cells in both", str(len(found.matched.labels)), alone)]
    names = found.beyond.names
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    numbers.append((f"{a} and {b} differ in", format_count(len(names), "value", "values"), "".join([*names[:1], more])))
    first = next(iter(answers(found, wanted).values()))
    difference, interval, n, *_ = first.cells
    return [*numbers, (f"{title(first.metric)}, {b} - {a}", difference, f"{interval}, {n} pairs: {first.word}")]


def _sides(sides: Sequence[Side]) -> Section:
    rows = [literals([side.name, side.folder.resolve().name, ", ".join(side.measurements.fixed), size_told(side)])
            for side in sides]  # fmt: skip
    return Section("The sweeps", (Table("What is compared.", ["name", "sweep", "fixed", "cells"], rows),))


def _sections(found: SweepComparison, wanted: Sequence[str]) -> list[Section]:
    alone = len(found.beyond.names) < 2
    told = literal(found.beyond.in_words(found.a.name, found.b.name))
    first: Block = Text(told) if alone else Notice("warning", "More than one thing differs", told)
    cells = Items([literal(text) for text in cells_told(found)])
    return [
        Section("What differs", [first, *_difference_tables(found), cells]),
        Section("Cell by cell", blocks(found, wanted)),
        Section("Every metric", table_blocks(found, wanted)),
    ]


def _caveats(sides: Sequence[Side]) -> Section:
    rows = [
        literals([one.side, one.rule, f"{one.count} of {one.cells}", one.worst])
        for side in sides
        for one in caveats_of(side)
    ]
    if not rows:
        return Section("Caveats", (Text("No rule found anything."),))
    caption = "Why results may not be what they seem: rules, cells with that caveat, and the worst of them."
    return Section("Caveats", (Table(caption, ["sweep", "caveat", "cells", "what was found"], rows, (2,)),))


def _made(sides: Sequence[Side]) -> Section:
    blocks: list[Block] = []
    for side in sides:
        blocks += [Text(f"{side.name} is made by"), Code(side.command)]
    rows = []
    for name in dict.fromkeys(name for side in sides for name in side.measurements.provenance):
        texts = {side.name: ", ".join(side.measurements.provenance.get(name, ["–"])) for side in sides}
        same = len(set(texts.values())) == 1
        rows += [(name, texts[sides[0].name])] if same else [(f"{name}, {side}", text) for side, text in texts.items()]
    return Section("Provenance", [*blocks, Provenance(rows)])


def _difference_tables(found: SweepComparison) -> list[Block]:
    """Return the resolved values that differ, and what made the runs where that differs."""
    a, b = found.a.name, found.b.name
    values = [*found.beyond.options, *found.beyond.values]
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
    if found.beyond.provenance:
        rows = [literals([value.key, value.a, value.b]) for value in found.beyond.provenance]
        blocks.append(Table("They were made by different versions.", ["made by", a, b], rows))
    return blocks
