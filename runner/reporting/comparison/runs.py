"""Report on several stored runs: metrics as rows, runs as columns, and their curves in the same axes."""

from collections.abc import Sequence

from runner.base.quantities import above_rounding, with_powers
from runner.base.sanitize import one_line
from runner.reporting.answers import PAIRS, Answer
from runner.reporting.challenge.beside import scope_line
from runner.reporting.comparison.differences import ConfigDifferences, find_differences
from runner.reporting.comparison.pairs import match
from runner.reporting.comparison.report import ComparisonSubject
from runner.reporting.comparison.sweeps import compare_runs, letter
from runner.reporting.document import Document, Notice, ReportBlock, Section, Table
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title, whole_metrics
from runner.reporting.overlaid_runs import Level, overlaid
from runner.reporting.run_report import config_blocks, provenance, run_blocks, run_name
from runner.reporting.sections import added_sections
from runner.reporting.sentences import sentences, short_table
from runner.reporting.spec_blocks import spec_of_several
from runner.reporting.table import numbers
from runner.store import Run
from runner.sweeps.changes import changed_keys
from runner.sweeps.measurements import measure_run

_MOST_CURVES = 8  # runs in one panel


def runs_document(runs: Sequence[Run]) -> Document:
    """Return the report on two or more stored runs; the others are compared with the first."""
    names = [letter(place) for place in range(len(runs))]
    sides = [measure_run(run, name) for run, name in zip(runs, names, strict=True)]
    differences = [find_differences(match(sides[0], side)) for side in sides[1:]]
    lines, compared = [], []
    for side in sides[1:]:
        answers, why = compare_runs(sides[0], side)
        lines += sentences(answers) or [f"{sides[0].name} and {side.name}: {why}."]
        compared.append(answers)
    lines += filter(None, [scope_line(compared[0], [run.folder for run in runs])])
    lines += [one.in_words(names[0], name) for one, name in zip(differences, names[1:], strict=True)]
    failed = [
        with_powers(f"{name} {run.failure}.") for name, run in zip(names, runs, strict=True) if run.status == "failed"
    ]
    caveats = [f"{name}: {', '.join(str(one['rule']) for one in run.caveats)}"
               for name, run in zip(names, runs, strict=True) if run.caveats]  # fmt: skip
    lines += [f"May mislead: {'; '.join(caveats)}."] if caveats else []
    details = [
        Section(
            f"{name}: {run_name(run)}", [*run_blocks(run), *config_blocks(run, changed_keys(run)), provenance([run])]
        )
        for name, run in zip(names, runs, strict=True)
    ]
    return Document(
        title=(len(runs) == 2 and differences[0].question(*names)) or f"{len(runs)} runs compared",
        subtitle=literal("; ".join(f"{name}: {run_name(run)}" for name, run in zip(names, runs, strict=True))),
        abstract=literal("\n".join(map(one_line, [*failed, *lines]))),
        sections=[
            Section("Side by side", _side_by_side(runs, names, differences, compared[0])),
            *added_sections("comparison", ComparisonSubject(sides)),
            *details,
        ],
        date=max(str(run.provenance["date"]) for run in runs),
        shown=1,
    )


def _side_by_side(
    runs: Sequence[Run], names: Sequence[str], differences: Sequence[ConfigDifferences], answers: Sequence[Answer]
) -> list[ReportBlock]:
    """Return the metrics as tables, of two runs with the differences in pairs; the curves, and the keys that differ."""
    values = [[*one.options, *one.values] for one in differences]
    firsts = {value.key: value.a for some in values for value in some}
    others = [{value.key: value.b for value in some} for some in values]
    rows = [[key, first, *(other.get(key, first) for other in others)] for key, first in firsts.items()]
    blocks: list[ReportBlock] = []
    if len(runs) == 2 and answers:
        caption = f"Each metric is a separate question. {PAIRS if any(one.interval for one in answers) else ''}"
        blocks.append(Table(literal(caption), *short_table(answers)))
    blocks += [*_curves(runs, names), _metrics(runs, names)]
    if rows:
        blocks.append(Table("Config values that differ.", ["key", *names], rows))
    return [*blocks, *spec_of_several(runs, names)]


def _metrics(runs: Sequence[Run], names: Sequence[str]) -> Table:
    """Return the medians of all whole metrics, one row each."""
    units = {name: metric.unit for run in runs for name, metric in run.metrics.items()}
    rows = []
    for name in whole_metrics(units):
        values = [run.metrics[name].median if name in run.metrics else None for run in runs]
        cells = ["–" if value is None else above_rounding(value, units[name]) for value in values]
        rows.append([title(name), *cells])
    return Table("Medians of the metrics.", ["metric", *numbers(*names)], rows)


def _curves(runs: Sequence[Run], names: Sequence[str]) -> list[ReportBlock]:
    blocks = overlaid([Level(name, [run], place) for place, (run, name) in enumerate(zip(runs, names, strict=True))]
                      [:_MOST_CURVES])  # fmt: skip
    if len(runs) > _MOST_CURVES:
        blocks.append(Notice("warning", f"{len(runs) - _MOST_CURVES} runs are not drawn", "The first ones are drawn."))
    return blocks
