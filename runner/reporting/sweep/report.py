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
from runner.reporting.challenge.beside import scope_line
from runner.reporting.comparison.pairs import label_text
from runner.reporting.comparison.sweeps import NOISE_ALONE, noise_alone
from runner.reporting.conditions import conditions_of
from runner.reporting.document import Document, Provenance, RunList, Section, Text
from runner.reporting.limits import limiting_joint
from runner.reporting.markup import literal
from runner.reporting.sections import added_sections, make_sections
from runner.reporting.sweep import distributions, effects, maps, spec, tradeoff
from runner.reporting.sweep.cells import (
    axes_section,
    caveats_section,
    failing_cells,
    failures_section,
    nothing_differs,
)
from runner.reporting.sweep.question import (
    answer_blocks,
    asked_axis,
    causes,
    made_equal,
    pairs_section,
    range_told,
    too_few,
)
from runner.reporting.sweep.stability import causes_of_failure, remedies
from runner.reporting.sweep.subject import Subject, SweepSubject, choose
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
    chosen = choose(measure_sweep(sweep), metrics)
    subject = SweepSubject(chosen.measurements, chosen.metrics, sweep, runs_address)
    first = [*make_sections(FIRST, subject), *added_sections("sweep", subject)]
    return Document(
        title=_title(subject),
        subtitle=", ".join(subject.measurements.fixed),
        abstract=literal("\n".join(map(one_line, _abstract(subject)))),
        sections=[*first, *make_sections(DETAILS, subject)],
        date=max(subject.measurements.provenance["made on"]),
        key_numbers=_key_numbers(subject),
        shown=len(first) or None,
        map=make_map(subject.answers),
    )


def _failures(subject: SweepSubject) -> Section | None:
    return failures_section(subject) if subject.measurements.failed else None


def _differences(subject: SweepSubject) -> Section | None:
    answers = subject.answers
    return Section("Differences in pairs", answer_blocks(answers, subject.texts[1:])) if answers else None


def _bounds(subject: SweepSubject) -> Section | None:
    return spec.section(subject, subject.sweep) if subject.sweep.spec else None


def _unanswered(subject: SweepSubject) -> Section | None:
    """Return the effects of the axes if the sweep has no answer."""
    if not subject.is_compared or subject.answers:
        return None
    return distributions.over_seeds(subject) if _has_seeds_alone(subject) else effects.section(subject)


def _axes(subject: SweepSubject) -> Section:
    return axes_section(subject, subject.sweep.command)


def _effects(subject: SweepSubject) -> Section | None:
    return effects.section(subject) if subject.answers else None


def _pairs(subject: SweepSubject) -> Section | None:
    return pairs_section(subject.answers)


def _maps(subject: SweepSubject) -> Section | None:
    return maps.section(subject) if subject.metrics and maps.is_readable(subject) else None


def _tradeoff(subject: SweepSubject) -> Section | None:
    pair = tradeoff.pair(subject) if subject.metrics else None
    return tradeoff.section(subject, pair) if pair is not None else None


def _distributions(subject: SweepSubject) -> Section | None:
    is_shown = subject.ranked and not (subject.is_compared and _has_seeds_alone(subject))
    return distributions.section(subject) if is_shown else None


def _motions(subject: SweepSubject) -> Section | None:
    """Return the motions of the condition with the largest difference; without an answer those of some cells."""
    if not subject.ranked:
        return None
    answers = subject.answers
    first = next((one.metric for one in answers if one.rank == 0), "")
    largest = max(conditions_of(answers, first), key=lambda each: each.size, default=None)
    pairs = [one.pairs for one in (largest.answers if largest else answers) if one.pairs and one.metric == first]
    compared = [int(cell) for some in pairs for of in (some.of_a, some.of_b) for cell in of]
    at = label_text(largest.at) if largest else ""
    shown = distributions.choose_cells(subject, compared or subject.ranked, at)
    cells = [cell for _, some, _ in shown.cells for cell in some]
    runs = dict(zip(cells, replace(subject.sweep, hashes=subject.hashes(cells)).runs(), strict=True))
    if compared:
        return distributions.motions_section(subject, shown, runs)
    return distributions.extremes_section(subject, shown, runs)


def _provenance(subject: SweepSubject) -> Section:
    return made_by(subject.measurements, ("sweep", subject.sweep.folder.name))


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


def _abstract(subject: SweepSubject) -> list[str]:
    """Return the failures and the answer, then the warnings: a paragraph each."""
    measurements, sweep, answers = subject.measurements, subject.sweep, subject.answers
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
        texts += [few] if few else [*subject.texts[:1], *causes(subject, answers)]
        if answers:
            texts += filter(None, [scope_line(answers, [sweep.folder]), made_equal(subject)])
        texts += effects.describe_shared_variation(subject) if subject.ranked and subject.axes else []
    rules = [f"{rule} ({count} of {cells} cells)" for rule, count, *_ in measurements.caveats_by_rule()]
    texts += [f"May mislead: {', '.join(rules)}; see Caveats."] if rules else []
    if noise_alone([measurements]):
        texts.append(NOISE_ALONE)
    return texts


def _all_runs(subject: SweepSubject) -> Section:
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
    listing = list_runs(
        subject.sweep, caption, order.tolist(), columns, measurements.failures, subject.runs_address, axes
    )
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


FIRST = (_failures, _differences, _bounds, _unanswered)
"""Sections that a page shows: functions of the subject that return a section or None; plug-ins add theirs behind."""
DETAILS = (
    caveats_section,
    _axes,
    _effects,
    _pairs,
    _maps,
    _tradeoff,
    _distributions,
    _motions,
    _all_runs,
    _provenance,
)
"""Sections that a page shows on a click."""
