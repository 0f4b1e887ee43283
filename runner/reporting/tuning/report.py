"""Report on a tuning, from its journal and its stored runs."""

import os
import shlex
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.config.compose.units import key_unit
from runner.reporting.answers import CHOSEN
from runner.reporting.document import Document, Notice, Origin, Provenance, RunList, Section, Table, Text
from runner.reporting.figures import cover
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import key_label
from runner.reporting.tuning.sections import (
    Subject,
    front_section,
    history_section,
    key_value,
    keys_section,
    trials_section,
)
from runner.store import Sweep, open_run
from runner.sweeps.measurements import Measurements, measure_sweep
from runner.sweeps.tuning.study import Tuning, at_ends

_MOST_FAILURES = 40


def tuning_document(tuning: Tuning, folder: Path) -> Document:
    """Return the report on a stored tuning.

    Args:
        tuning: The tuning.
        folder: Where the report will stand: its links to the runs lead from there.

    Raises:
        StoreError: If a run is missing or damaged.
    """
    subject = Subject(tuning)
    made = [place for place, trial in enumerate(subject.trials) if trial.run]
    overrides = [tuning.study.trial_overrides(subject.trials[place]) for place in made]
    sweep = Sweep(tuning.folder, overrides, subject.runs(made), tuning.study.command)
    measurements = measure_sweep(sweep)
    sections, shown = [_what(subject)], None
    if subject.good:
        sections += [history_section(subject), keys_section(subject)]
        if len(subject.objectives) > 1:
            sections.insert(2, front_section(subject))
        places = list(subject.best_by_objective())
        runs = {place: open_run(sweep.outputs / "runs" / subject.trials[place].run) for place in places}
        commands = {place: _command(tuning.study.trial_overrides(subject.trials[place])) for place in places}
        sections.append(trials_section(subject, runs, commands))
        shown = cover(runs[places[0]], f"The motion of trial {places[0]}, the chosen one.")
    if len(subject.good) < len(subject.trials):
        sections.append(_failures(subject))
    sections.append(_all_runs(subject, sweep, made, measurements, folder))
    made_by = [(name, ", ".join(values)) for name, values in measurements.provenance.items()]
    sections.append(Section("Provenance", (Provenance([*made_by, ("tuning", tuning.folder.name)]),)))
    goals = " and ".join(f"{objective.direction} the {title(objective.metric)}" for objective in subject.objectives)
    return Document(
        title=f"Tuning to {goals}",
        subtitle=", ".join(tuning.study.overrides),
        abstract=literal(_abstract(subject)),
        sections=sections,
        date=max(measurements.provenance.get("made on", [""])),
        cover=shown,
        key_numbers=_key_numbers(subject),
        figures_float=False,
    )


def _key_numbers(subject: Subject) -> list[tuple[str, str, str]]:
    """Return how many trials there are, and the chosen value of each objective with the keys that give it."""
    failed = len(subject.trials) - len(subject.good)
    numbers = [("trials", str(len(subject.trials)), f"{failed} of them failed" if failed else "none failed")]
    for place, objectives in (subject.best_by_objective() if subject.good else {}).items():
        for objective in objectives:
            value = subject.trials[place].values[list(subject.objectives).index(objective)]
            chosen = f"trial {place}: {subject.settings(place)}"
            numbers.append((f"{title(objective.metric)}, chosen", quantity(value, objective.unit), chosen))
    return numbers


def summary_of_tuning(tuning: Tuning) -> str:
    """Return what a tuning chose, in a sentence; empty if no trial is good."""
    subject = Subject(tuning)
    if len(subject.best) != 1:
        return f"{len(subject.best)} trials are on the Pareto front." if subject.best else ""
    return f"Trial {subject.best[0]}: {subject.outcome(subject.best[0])}, with {subject.settings(subject.best[0])}."


def _abstract(subject: Subject) -> str:
    names = ", ".join(key.name for key in subject.keys)
    text = f"{len(subject.trials)} trials over {names}; {len(subject.trials) - len(subject.good)} of them failed."
    if len(subject.best) == 1:
        trial = subject.best[0]
        text += f" Chosen is trial {trial}: {subject.outcome(trial)}, with {subject.settings(trial)}."
    elif subject.best:
        text += f" {len(subject.best)} trials are on the Pareto front."
    return " ".join([text, *at_ends(subject.tuning), *([CHOSEN] if subject.best else [])])


def _what(subject: Subject) -> Section:
    rows = [
        [
            key_label(key.name),
            key_value(key.low),
            key_value(key.high),
            "logarithmic" if key.log else "linear",
            "any" if key.step is None and not key.integer else f"by {key_value(key.step or 1)}",
        ]
        for key in subject.keys
    ]
    study = subject.tuning.study
    text = Text(
        "The first ten trials are drawn at random; each later one follows from what came before it (tree-structured "
        f"Parzen estimator of Optuna), {study.at_once} of them under way at once. Of a metric the median over the "
        "repetitions counts. The same command gives the same trials, on however many processes."
    )
    header = ["key", "low", "high", "scale", "values"]
    origin = Origin(command=study.command)
    table = Table("Tuned keys with their ranges.", header, [literals(row) for row in rows], (1, 2), origin)
    failed = len(subject.trials) - len(subject.good)
    if not failed:
        return Section("What was tuned", (table, text))
    notice = Notice(
        "failure",
        f"{failed} of {len(subject.trials)} trials failed",
        "They rank behind all others, so that the search keeps away from them; a section of its own lists them.",
    )
    return Section("What was tuned", (table, text, notice))


def _failures(subject: Subject) -> Section:
    failed = [place for place, trial in enumerate(subject.trials) if trial.failure]
    rows = []
    for place in failed[:_MOST_FAILURES]:
        trial = subject.trials[place]
        rows.append(literals([str(place), trial.run[:8] or "–", subject.settings(place), trial.failure]))
    left = len(failed) - len(rows)
    more = f" {left} more stand in the list of runs." if left else ""
    return Section("Failed trials", (Table(f"Failed trials.{more}", ["trial", "run", "values", "failure"], rows),))


def _all_runs(subject: Subject, sweep: Sweep, made: list[int], measurements: Measurements, folder: Path) -> Section:
    goals = [objective.metric for objective in subject.objectives if objective.metric in measurements.values]
    others = [name for name in measurements.values if name not in goals]
    columns: list[tuple[str, str, Sequence[float] | FloatArray]] = [("trial", "1", made)]
    columns += [(name, measurements.units[name], measurements.medians(name)) for name in goals]
    columns += [
        (key.name, key_unit(key.name), [subject.trials[place].params[key.name] for place in made])
        for key in subject.keys
    ]
    columns += [(name, measurements.units[name], measurements.medians(name)) for name in others]
    values = np.column_stack([np.array(column, dtype=float) for *_, column in columns])
    address = os.path.relpath(sweep.outputs / "runs", folder)
    listing = RunList(
        "All runs, in the order of the trials; medians of each.",
        [],
        np.zeros((len(made), 0), dtype=np.intp),
        [(name, unit) for name, unit, _ in columns],
        np.where(np.isfinite(values), values, np.nan),
        sweep.hashes,
        [subject.trials[place].failure for place in made],
        [_command(overrides) for overrides in sweep.overrides],
        [f"{address}/{name}/" if (sweep.outputs / "runs" / name).is_dir() else "" for name in sweep.hashes],
    )
    text = Text("In the HTML report a click on a point, here or in any figure, shows its run.")
    return Section("All runs", (text, listing))


def _command(overrides: Sequence[str]) -> str:
    return shlex.join(["runner", *overrides])
