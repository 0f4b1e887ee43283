"""Report on a sweep: answers, axes, effects, maps, trade-off, distributions, failures and runs."""

import shlex
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.dotted_keys import split_override
from runner.base.quantities import in_one_unit
from runner.base.sanitize import few, one_line
from runner.reporting.answer_map import make_map
from runner.reporting.answers import Answer
from runner.reporting.challenge.beside import scope_line
from runner.reporting.comparison.pairs import label_text
from runner.reporting.comparison.sweeps import NOISE_ALONE, noise_alone
from runner.reporting.conditions import conditions_of
from runner.reporting.document import Document, Provenance, RunList, Section, Text
from runner.reporting.limits import limiting_joint
from runner.reporting.markup import literal
from runner.reporting.sentences import sentences
from runner.reporting.sweep import distributions, effects, maps, spec, tradeoff
from runner.reporting.sweep.cells import (
    axes_section,
    caveats_sections,
    failing_cells,
    failures_section,
    nothing_differs,
)
from runner.reporting.sweep.question import (
    answer_blocks,
    asked_axis,
    causes,
    find_answers,
    made_equal,
    pairs_section,
    range_told,
    too_few,
)
from runner.reporting.sweep.stability import causes_of_failure, remedies
from runner.reporting.sweep.subject import Subject, choose
from runner.reporting.words import join_values
from runner.store import Sweep
from runner.sweeps.measurements import Measurements, measure_sweep
from runner.sweeps.question import SEED

MOST_RUNS = 5000
"""Runs that the list of a report holds; of more, those at both ends of the order."""

_MOST_VALUES = 100  # of what made the runs
_MOST_CHOICES = 4  # that the title names
_NAMED = 3  # cells that failed, on the first screen


def sweep_document(sweep: Sweep, metrics: Sequence[str] = (), runs_address: str = "") -> Document:
    """Return the report on a stored sweep.

    Args:
        sweep: The sweep.
        metrics: Metrics that it compares; the first one ranks the cells; empty chooses those that differ.
        runs_address: Address of the folder of runs, seen from the report, ending in a slash.

    Raises:
        RunnerError: If a metric is none of the sweep's.
        StoreError: If a run is missing or damaged.
    """
    subject = choose(measure_sweep(sweep), metrics)
    measurements = subject.measurements
    answers = find_answers(subject)
    several = bool(subject.metrics and subject.axes)
    seeds_alone = several and _has_seeds_alone(subject)
    sections = [failures_section(subject)] if measurements.failed else []
    texts = sentences(answers)
    if answers:
        sections.append(Section("Differences in pairs", answer_blocks(answers, texts[1:])))
    if sweep.spec:
        sections.append(spec.section(subject, sweep))
    if several and not answers:
        sections.append(distributions.over_seeds(subject) if seeds_alone else effects.section(subject))
    shown = len(sections) or None
    sections += caveats_sections(subject)
    sections.append(axes_section(subject, sweep.command))
    ranked = subject.ranked
    if several:
        sections += [effects.section(subject)] if answers else []
        compared = pairs_section(answers)
        sections += [compared] if compared is not None else []
    if subject.metrics and maps.is_readable(subject):
        sections.append(maps.section(subject))
    traded = tradeoff.pair(subject) if subject.metrics else None
    if traded is not None:
        sections.append(tradeoff.section(subject, traded))
    if ranked:
        sections += [] if seeds_alone else [distributions.section(subject)]
        sections.append(_motions(subject, sweep, answers))
    sections.append(_all_runs(subject, sweep, runs_address))
    sections.append(made_by(measurements, ("sweep", sweep.folder.name)))
    return Document(
        title=_title(subject),
        subtitle=", ".join(measurements.fixed),
        abstract=literal("\n".join(map(one_line, _abstract(subject, sweep, answers, texts[:1])))),
        sections=sections,
        date=max(measurements.provenance["made on"]),
        key_numbers=_key_numbers(subject),
        shown=shown,
        map=make_map(answers),
    )


def _motions(subject: Subject, sweep: Sweep, answers: Sequence[Answer]) -> Section:
    """Return the motions of the condition with the largest difference; without an answer those of some cells."""
    first = next((one.metric for one in answers if one.rank == 0), "")
    found = max(conditions_of(answers, first), key=lambda each: each.size, default=None)
    pairs = [one.pairs for one in (found.answers if found else answers) if one.pairs and one.metric == first]
    compared = [int(cell) for some in pairs for of in (some.of_a, some.of_b) for cell in of]
    at = label_text(found.at) if found else ""
    shown = distributions.choose_cells(subject, compared or subject.ranked, at)
    cells = [cell for _, some, _ in shown.cells for cell in some]
    runs = dict(zip(cells, replace(sweep, hashes=subject.hashes(cells)).runs(), strict=True))
    if compared:
        return distributions.motions_section(subject, shown, runs)
    return distributions.extremes_section(subject, shown, runs)


def _key_numbers(subject: Subject) -> list[tuple[str, str, str]]:
    """Return the numbers of cells and of failed ones, and the range of the medians of the first metric."""
    failed = [cell for cell, status in enumerate(subject.measurements.statuses) if status != "ok"]
    count = len(subject.measurements.hashes)
    numbers = [("cells", str(count), f"repetitions in each: {subject.measurements.repetitions}")]
    numbers.append(("failed", str(len(failed)), few([*map(subject.cell_name, failed)], _NAMED, "; ")))
    found = range_told(subject)
    if found is not None:
        metric = subject.metrics[0]
        values = subject.measurements.values[metric]
        medians = [float(subject.medians[metric][cell]) for cell in (subject.ranked[0], subject.ranked[-1])]
        worst = float(values[np.isfinite(values)].max())
        *_, worst_text = in_one_unit([*medians, worst], subject.measurements.units[metric])
        numbers.append((found[0], found[1], f"medians of the cells; worst draw {worst_text}"))
    sides = [(subject.measurements, np.arange(count))]
    joint = limiting_joint(sides)
    return [*numbers, ("at its torque limit", *joint)] if joint[0] else numbers


def _has_seeds_alone(subject: Subject) -> bool:
    """Tell if a sweep varies nothing but the seed, whose values mean nothing."""
    return [axis.name for axis in subject.axes] == [SEED]


def _title(subject: Subject) -> str:
    axis = asked_axis(subject)
    if axis is None:
        conditions = ", ".join(other.name for other in subject.axes if other.name != SEED)
        if conditions:
            return f"What {conditions} changes"
        return "Sweep of one cell" if not subject.axes else "Sweep over seeds"
    others = [other.name for other in subject.axes if other is not axis]
    within = f", over {', '.join(others)}" if others else ""
    names = [axis.text(level) for level in range(len(axis.values))]
    choices = f"{', '.join(names[:-1])} or {names[-1]}" if 1 < len(names) <= _MOST_CHOICES else f"{len(names)} values"
    return f"Which {axis.name}: {choices}{within}?" if axis.numbers is None else f"What {axis.name} changes{within}"


def _abstract(subject: Subject, sweep: Sweep, answers: Sequence[Answer], first: Sequence[str]) -> list[str]:
    """Return the failures and the answer, then the warnings: a paragraph each."""
    measurements = subject.measurements
    cells, failed = len(measurements.hashes), measurements.failed
    texts = []
    if failed:
        what = [f"{failed} of {cells} cells failed.", *(remedies(subject) or [failing_cells(subject)])]
        texts.append(" ".join(filter(None, [*what, causes_of_failure(subject)])))
    texts += filter(None, [nothing_differs(subject)])
    if sweep.spec:
        texts.append(spec.summary(subject, sweep))
    if subject.ranked and _has_seeds_alone(subject):
        texts.append(distributions.told_over_seeds(subject))
    else:
        few = too_few(subject) if subject.ranked and subject.axes else ""
        texts += [few] if few else [*first, *causes(subject, answers)]
        if answers:
            texts += filter(None, [scope_line(answers, [sweep.folder]), made_equal(subject)])
        texts += effects.describe_shared_variation(subject) if subject.ranked and subject.axes else []
    rules = [f"{rule} ({count} of {cells} cells)" for rule, count, *_ in measurements.caveats_by_rule()]
    texts += [f"May mislead: {', '.join(rules)}; see Caveats."] if rules else []
    if noise_alone([measurements]):
        texts.append(NOISE_ALONE)
    return texts


def _all_runs(subject: Subject, sweep: Sweep, address: str) -> Section:
    measurements = subject.measurements
    order = subject.order
    caption = "All runs, in the order of the first metric; medians of each."
    if len(order) > MOST_RUNS:
        order = np.concatenate([order[: MOST_RUNS // 2], order[-MOST_RUNS // 2 :]])
        caption = f"The first and the last {MOST_RUNS // 2} of {len(measurements.hashes)} runs by the first metric."
    names = list(dict.fromkeys([*subject.metrics, *measurements.values]))
    medians = [subject.medians[name][order] for name in names]
    shown = [(name, measurements.units[name]) for name in names]
    if any(measurements.caveats):  # behind the metrics that are compared
        counts = np.array([len(found) for found in measurements.caveats], dtype=float)
        medians.insert(len(subject.metrics), counts[order])
        shown.insert(len(subject.metrics), ("caveats", "1"))
    named = [(axis, *np.unique(axis.level[order], return_inverse=True)) for axis in subject.axes]
    axes = [(axis.name, [axis.text(level) for level in some.tolist()], level) for axis, some, level in named]
    columns = [(*head, column) for head, column in zip(shown, medians, strict=True)]
    listing = list_runs(sweep, caption, order.tolist(), columns, measurements.failures, address, axes)
    text = Text(
        "In the HTML report: filter by value, plot any two quantities against each other, sort by a column; a click on "
        "a point, here or in any figure, shows its run. The command runner table writes all numbers as Parquet and CSV."
    )
    return Section("All runs", (text, listing))


def list_runs(
    sweep: Sweep,
    caption: str,
    cells: Sequence[int],
    columns: Sequence[tuple[str, str, FloatArray]],
    failures: Sequence[str],
    address: str,
    axes: Sequence[tuple[str, Sequence[str], NDArray[np.intp]]] = (),
) -> RunList:
    """Return the list of some runs of a sweep.

    Args:
        sweep: The sweep.
        caption: Caption.
        cells: The cells, in order.
        columns: Name, unit and value in each of these cells, such as the median of a metric.
        failures: Reason of the failure of each cell of the sweep; empty for a successful one.
        address: Address of the folder of runs, seen from the report, ending in a slash.
        axes: Name, names of the values, and index of the value of each of these cells.
    """
    hashes = [sweep.hashes[cell] for cell in cells]
    values = np.column_stack([column for *_, column in columns] or [np.zeros((len(hashes), 0))])
    return RunList(
        caption,
        [(name, names) for name, names, _ in axes],
        np.column_stack([level for *_, level in axes] or [np.zeros((len(hashes), 0), dtype=np.intp)]),
        [(name, unit) for name, unit, _ in columns],
        np.where(np.isfinite(values), values, np.nan),
        hashes,
        [failures[cell] for cell in cells],
        [run_command(sweep.overrides[cell]) for cell in cells],
        [f"{address}{name}/" if (sweep.outputs / "runs" / name).is_dir() else "" for name in hashes],
    )


def made_by(measurements: Measurements, name: tuple[str, str]) -> Section:
    """Return the provenance of the runs, and the name of their sweep or tuning."""
    rows = [(what, join_values(_some(values))) for what, values in measurements.provenance.items()]
    return Section("Provenance", (Provenance([*rows, name]),))


def _some(values: Sequence[str]) -> Sequence[str]:
    """Return values, of very many the first and the last."""
    return values if len(values) <= _MOST_VALUES else [*values[:3], f"... ({len(values)} values)", values[-1]]


def run_command(overrides: Sequence[str]) -> str:
    """Return the command of a run."""
    return shlex.join(["runner", *(text for text in overrides if split_override(text)[0] != "outputs")])
