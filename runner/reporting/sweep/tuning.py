"""Report on a tuning: a sweep whose cells are trials, with the history of its objectives and the chosen trials."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number, quantity
from runner.plugins.metric_units import units
from runner.reporting.answers import CHOSEN, Answer
from runner.reporting.challenge.beside import scope_line
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.comparison.sweeps import compare_runs
from runner.reporting.document import Curves, Document, Notice, Origin, Panel, ReportBlock, Section, Series, Table, Text
from runner.reporting.figures import cover
from runner.reporting.markup import literal
from runner.reporting.metric_titles import metric_label, title
from runner.reporting.overlaid_runs import Level
from runner.reporting.sections import added_sections, make_sections
from runner.reporting.sentences import sentences
from runner.reporting.sweep.cells import caveats_section, failed_table
from runner.reporting.sweep.distributions import motion_blocks
from runner.reporting.sweep.question import answer_blocks
from runner.reporting.sweep.report import list_runs, made_by, run_command
from runner.reporting.sweep.subject import Subject, key_label, main_metrics, spans_decades
from runner.reporting.table import numbers
from runner.store import Run, Sweep, open_run
from runner.sweeps.finer_step import work_out
from runner.sweeps.measurements import Measurements, measure_run, measure_sweep
from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective, best
from runner.sweeps.tuning.study import Tuning, at_ends

_MOST_ROWS = 20


@dataclass(frozen=True)
class TuningSubject:
    """A tuning as its report looks at it: the subject of the sections of the report.

    Attributes:
        tuning: The tuning.
        runs_address: Address of the folder of runs, seen from the report, ending in a slash.
    """

    tuning: Tuning
    runs_address: str = ""

    @property
    def keys(self) -> Sequence[TunedKey]:
        """The tuned keys."""
        return self.tuning.study.keys

    @property
    def objectives(self) -> Sequence[Objective]:
        """The objectives."""
        return self.tuning.study.objectives

    @cached_property
    def good(self) -> list[int]:
        """Numbers of the trials that did not fail."""
        return [place for place, trial in enumerate(self.tuning.trials) if not trial.failure]

    @cached_property
    def best(self) -> list[int]:
        """Numbers of the best trials: one, or the Pareto front."""
        return best(self.tuning.trials, self.objectives)

    @cached_property
    def made(self) -> list[int]:
        """Numbers of the trials that have a run."""
        return [place for place, trial in enumerate(self.tuning.trials) if trial.run]

    @cached_property
    def sweep(self) -> Sweep:
        """The runs of the trials, as a sweep."""
        trials = [self.tuning.trials[place] for place in self.made]
        overrides = [self.tuning.study.trial_overrides(trial) for trial in trials]
        return Sweep(self.tuning.folder, overrides, [trial.run for trial in trials], self.tuning.study.command)

    @cached_property
    def measurements(self) -> Measurements:
        """Metrics of these runs."""
        return measure_sweep(self.sweep)

    @cached_property
    def chosen(self) -> dict[int, Run]:
        """The run of each chosen trial; empty if none is good."""
        places = self.best_by_objective() if self.good else {}
        return {place: open_run(self.sweep.outputs / "runs" / self.tuning.trials[place].run) for place in places}

    @cached_property
    def on_fresh_seed(self) -> tuple[list[Answer], list[str]]:
        """The tuned config compared with the default one, and that in sentences; see compare_on_fresh_seed."""
        return compare_on_fresh_seed(self.tuning)

    def values(self, place: int) -> FloatArray:
        """Return the value of an objective in each trial, shape (trials,)."""
        return np.array([trial.values[place] for trial in self.tuning.trials], dtype=float)

    def params(self, key: TunedKey) -> FloatArray:
        """Return the value of a key in each trial, shape (trials,)."""
        return np.array([trial.params[key.name] for trial in self.tuning.trials], dtype=float)

    def points(self, name: str, x: FloatArray, y: FloatArray, trials: Sequence[int]) -> Series:
        """Return points of some trials, each with its settings and its run; x and y have shape (trials,)."""
        hints = [f"trial {place}: {self.settings(place)}; {self.outcome(place)}" for place in trials]
        runs = [self.tuning.trials[place].run for place in trials]
        return Series(name, x[trials], y[trials], "points", hints=hints, runs=runs)

    def settings(self, place: int) -> str:
        """Return the values of the keys in a trial."""
        return ", ".join(f"{key.name}={self.tuning.trials[place].params[key.name]:.3g}" for key in self.keys)

    def outcome(self, place: int) -> str:
        """Return the values of the objectives in a good trial."""
        values = zip(self.objectives, self.tuning.trials[place].values, strict=True)
        return ", ".join(f"{title(objective.metric)} {quantity(value, objective.unit)}" for objective, value in values)

    def command(self, place: int) -> str:
        """Return the command of a trial."""
        return run_command(self.tuning.study.trial_overrides(self.tuning.trials[place]))

    def best_by_objective(self) -> dict[int, list[Objective]]:
        """Return the trials on the front that are best in an objective, with the objectives that each is best in."""
        found: dict[int, list[Objective]] = {}
        for index, objective in enumerate(self.objectives):
            losses = objective.sign * self.values(index)
            found.setdefault(min(self.best, key=lambda place: losses[place]), []).append(objective)
        return found


def tuning_document(tuning: Tuning, folder: Path) -> Document:
    """Return the report on a stored tuning.

    Args:
        tuning: The tuning.
        folder: Folder of the report, from which its links to the runs lead.

    Raises:
        StoreError: If a run is missing or damaged.
    """
    subject = TuningSubject(tuning, f"{os.path.relpath(tuning.folder.parents[1] / 'runs', folder)}/")
    answers, texts = subject.on_fresh_seed
    texts = [*texts[:1], *filter(None, [scope_line(answers, [tuning.folder])]), *texts[1:]]
    first = next(iter(subject.chosen), None)
    goals = " and ".join(f"{objective.direction} the {title(objective.metric)}" for objective in subject.objectives)
    return Document(
        title=f"Tuning to {goals}",
        subtitle=", ".join(tuning.study.overrides),
        abstract=literal("\n".join([*texts, _abstract(subject)])),
        sections=[
            *make_sections(FIRST, subject),
            *added_sections("tuning", subject),
            *make_sections(DETAILS, subject),
        ],
        date=max(subject.measurements.provenance.get("made on", [""])),
        cover=None if first is None else cover(subject.chosen[first], f"The motion of trial {first}, the chosen one."),
        key_numbers=_key_numbers(subject),
    )


def _compared(subject: TuningSubject) -> Section | None:
    answers, _ = subject.on_fresh_seed
    drawn = any(not one.comparison.exact for one in answers)
    heading = "Default and tuned on a fresh seed" if drawn else "Default and tuned"
    return Section(heading, answer_blocks(answers)) if answers else None


def compare_on_fresh_seed(tuning: Tuning) -> tuple[list[Answer], list[str]]:
    """Return the tuned config compared with the default one on a seed that chose nothing, and that in sentences."""
    if tuning.fresh is None:
        return [], [CHOSEN] if best(tuning.trials, tuning.study.objectives) else []
    names = "default", f"trial {tuning.fresh.trial}"
    outputs = tuning.folder.parents[1]
    runs = [open_run(outputs / "runs" / run) for run in (tuning.fresh.default, tuning.fresh.tuned)]
    work_out(outputs, runs)
    sides = [measure_run(run, name) for run, name in zip(runs, names, strict=True)]
    metrics = [*(objective.metric for objective in tuning.study.objectives), *main_metrics(sides)]
    answers, why = compare_runs(sides[0], sides[1], list(dict.fromkeys(metrics)))
    seed, repetitions = (runs[0].config[key] for key in ("seed", "repetitions"))
    failed = [f"{name} {run.failure}." for name, run in zip(names, runs, strict=True) if run.failure]
    texts = sentences(answers) or [f"{why}."]
    drawn = f"Default and tuned on fresh draws: seed {seed}, {repetitions} repetitions; no trial was chosen by them."
    if answers and all(one.comparison.exact for one in answers):
        drawn = "Nothing is drawn in default and tuned: the compared values are those that chose the trial."
    return answers, [*texts[:1], *failed, drawn, *texts[1:]]


def _key_numbers(subject: TuningSubject) -> list[tuple[str, str, str]]:
    """Return the number of trials, and the chosen value of each objective with the keys that give it."""
    count = len(subject.tuning.trials)
    failed = count - len(subject.good)
    numbers = [("trials", str(count), f"{failed} of them failed" if failed else "none failed")]
    for place, objectives in (subject.best_by_objective() if subject.good else {}).items():
        for objective in objectives:
            value = subject.tuning.trials[place].values[list(subject.objectives).index(objective)]
            chosen = f"trial {place}: {subject.settings(place)}"
            numbers.append((f"{title(objective.metric)}, chosen", quantity(value, objective.unit), chosen))
    return numbers


def summary_of_tuning(tuning: Tuning) -> str:
    """Return the choice of a tuning in a sentence; empty if no trial is good."""
    subject = TuningSubject(tuning)
    if len(subject.best) > 1:
        return f"{len(subject.best)} trials are on the Pareto front."
    return "".join(
        f"Trial {place}: {subject.outcome(place)}, with {subject.settings(place)}." for place in subject.best
    )


def _abstract(subject: TuningSubject) -> str:
    names = ", ".join(key.name for key in subject.keys)
    count = len(subject.tuning.trials)
    texts = [f"{count} trials over {names}; {count - len(subject.good)} of them failed."]
    chosen = summary_of_tuning(subject.tuning)
    texts += [f"Chosen is t{chosen[1:]}" if len(subject.best) == 1 else chosen, *at_ends(subject.tuning)]
    return " ".join(filter(None, texts))


def _what(subject: TuningSubject) -> Section:
    rows = [
        [
            key_label(key),
            number(key.low),
            number(key.high),
            "logarithmic" if key.log else "linear",
            "any" if key.step is None and not key.integer else f"by {number(key.step or 1)}",
        ]
        for key in subject.keys
    ]
    study = subject.tuning.study
    text = Text(
        "The first ten trials cover the ranges evenly; each later one follows from those before it (tree-structured "
        f"Parzen estimator of Optuna), {study.at_once} of them under way at once. Of a metric the median over the "
        "repetitions counts. The same command gives the same trials, on however many processes."
    )
    header = ["key", *numbers("low", "high"), "scale", "values"]
    blocks: list[ReportBlock] = [
        Table("Tuned keys with their ranges.", header, rows, Origin(command=study.command)),
        text,
    ]
    failed = len(subject.tuning.trials) - len(subject.good)
    if failed:
        told = "They rank behind all others, so that the search keeps away from them; a separate section lists them."
        blocks.append(Notice("failure", f"{failed} of {len(subject.tuning.trials)} trials failed", told))
    return Section("What was tuned", blocks)


def history_section(subject: TuningSubject) -> Section | None:
    """Return the history of each objective, with the chosen value so far; None without a good trial."""
    if not subject.good:
        return None
    numbers = np.arange(len(subject.tuning.trials), dtype=float)
    panels = []
    for index, objective in enumerate(subject.objectives):
        values = subject.values(index)
        drawn = subject.points("trials", numbers, values, subject.good)
        so_far = objective.sign * np.minimum.accumulate(objective.sign * drawn.y)
        series = [drawn, Series("chosen so far", drawn.x, so_far, "line")]
        panels.append(Panel("", "trial", _label(objective), series, y_log=spans_decades(drawn.y)))
    failed = len(numbers) - len(subject.good)
    without = f" {failed} failed trials have no point." if failed else ""
    return Section("History", [Curves(f"Each good trial, and the chosen value so far.{without}", panels)])


def _label(objective: Objective) -> str:
    return metric_label(objective.metric, objective.unit)


def _front(subject: TuningSubject) -> Section | None:
    """Return the front, a figure for each pair of objectives, and its trials; of a long front some along all of it."""
    if not subject.good or len(subject.objectives) == 1:
        return None
    objectives, front = subject.objectives, subject.best
    panels = []
    for a, b in combinations(range(len(objectives)), 2):
        x, y = subject.values(a), subject.values(b)
        series = [subject.points("trials", x, y, subject.good), subject.points("front", x, y, front)]
        logs = spans_decades(x[subject.good]), spans_decades(y[subject.good])
        panels.append(Panel("", _label(objectives[a]), _label(objectives[b]), series, *logs))
    rows = []
    for place in (front[index] for index in spaced_indices(len(front), _MOST_ROWS)):
        found = subject.tuning.trials[place]
        values = zip(objectives, found.values, strict=True)
        settings = [number(found.params[key.name]) for key in subject.keys]
        rows.append([str(place), *(quantity(value, objective.unit) for objective, value in values), *settings])
    header = numbers("trial", *(title(each.metric) for each in objectives), *(key.name for key in subject.keys))
    text = (
        f"The front has {len(front)} of {len(subject.good)} good trials: none of them gets better in one objective "
        "without another getting worse."
    )
    blocks: list[ReportBlock] = [
        Text("Every objective chooses the same trial." if len(front) == 1 else text),
        Curves("Good trials and the Pareto front.", panels, columns=1 if len(objectives) == 2 else 2),
        Table("Trials on the front.", header, rows),
    ]
    return Section("Trade-off", blocks)


def _keys(subject: TuningSubject) -> Section | None:
    if not subject.good:
        return None
    panels = []
    for index, objective in enumerate(subject.objectives):
        y = subject.values(index)
        for key in subject.keys:
            x = subject.params(key)
            series = [subject.points("trials", x, y, subject.good), subject.points("chosen", x, y, subject.best)]
            limits, logs = (key.low, key.high), (key.log, spans_decades(y[subject.good]))
            panels.append(Panel("", key_label(key), _label(objective), series, *logs, limits))
    return Section("Keys", [Curves("Good trials over the range of each key.", panels), _importance(subject)])


def _importance(subject: TuningSubject) -> ReportBlock:
    from runner.sweeps.tuning.sampler import importances  # imports Optuna

    found = [
        importances(subject.keys, subject.tuning.trials, objective, place)
        for place, objective in enumerate(subject.objectives)
    ]
    if not all(found):
        return Text("Of fewer than 20 good trials it cannot be said which key matters.")
    rows = [[key.name, *(f"{100 * shares[key.name]:.0f} %" for shares in found)] for key in subject.keys]
    caption = (
        "Importance of the keys: how far the values of each in the leading tenth of the good trials differ from those "
        "among all of them, in shares (PED-ANOVA). Where trials crowd, it says what still decides there."
    )
    return Table(caption, ["key", *numbers(*(title(objective.metric) for objective in subject.objectives))], rows)


def _chosen(subject: TuningSubject) -> Section | None:
    if not subject.good:
        return None
    one = len(subject.objectives) == 1
    sections = []
    for place, objectives in subject.best_by_objective().items():
        best_in = ", ".join(f"{objective.direction} the {title(objective.metric)}" for objective in objectives)
        head = f"Trial {place}" if one else f"Trial {place}: {best_in}"
        sections.append(Section(head, _trial(subject, place, subject.chosen[place])))
    return Section("Chosen trial" if one else "Chosen by each objective", (), sections)


def _trial(subject: TuningSubject, place: int, run: Run) -> list[ReportBlock]:
    params = subject.tuning.trials[place].params
    rows = [
        [key_label(key), number(params[key.name]), f"{number(key.low)} to {number(key.high)}"] for key in subject.keys
    ]
    goals = [objective.metric for objective in subject.objectives]
    names = dict.fromkeys([*goals, *(name for name in run.metrics if name in units())])
    metrics = [[title(name), run.metrics[name].text] for name in names]
    told = "Medians, in brackets smallest and largest over the repetitions."
    return [
        Table("Tuned keys.", ["key", *numbers("value", "range")], rows, Origin(command=subject.command(place))),
        *motion_blocks([Level("", [run], 0)]),
        Table(told, ["metric", *numbers("value")], metrics),
    ]


def _failed(subject: TuningSubject) -> Section | None:
    rows = [
        [str(place), trial.run[:8] or "–", subject.settings(place), trial.failure]
        for place, trial in enumerate(subject.tuning.trials)
        if trial.failure
    ]
    table = failed_table("trials", ["trial", "run", "values", "failure"], rows)
    return Section("Failed trials", (table,)) if rows else None


def _caveats(subject: TuningSubject) -> Section | None:
    return caveats_section(Subject(subject.measurements, ()))


def _all_runs(subject: TuningSubject) -> Section:
    measurements, made = subject.measurements, subject.made
    goals = [objective.metric for objective in subject.objectives if objective.metric in measurements.values]
    metrics = [(name, measurements.units[name], measurements.medians(name)) for name in measurements.values]
    columns = [
        ("trial", "1", np.array(made, dtype=float)),
        *(next(column for column in metrics if column[0] == name) for name in goals),
        *((key.name, key.unit, subject.params(key)[made]) for key in subject.keys),
        *(column for column in metrics if column[0] not in goals),
    ]
    failures = [subject.tuning.trials[place].failure for place in made]
    caption = "All runs, in the order of the trials; medians of each."
    text = Text("In the HTML report a click on a point, here or in any figure, shows its run.")
    listing = list_runs(subject.sweep, caption, range(len(made)), columns, failures, subject.runs_address)
    return Section("All runs", (text, listing))


def _provenance(subject: TuningSubject) -> Section:
    return made_by(subject.measurements, ("tuning", subject.tuning.folder.name))


FIRST = (_compared, _what, history_section, _front, _keys, _chosen)
DETAILS = (_failed, _caveats, _all_runs, _provenance)
"""Sections before and after those of plug-ins: functions of the subject that return a section or None."""
