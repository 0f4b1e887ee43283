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
from runner.reporting.sections import make_sections
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
class Trials:
    """The trials of a tuning as its report looks at them.

    Attributes:
        tuning: The tuning.
    """

    tuning: Tuning

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
    trials = Trials(tuning)
    made = [place for place, trial in enumerate(tuning.trials) if trial.run]
    overrides = [tuning.study.trial_overrides(tuning.trials[place]) for place in made]
    sweep = Sweep(tuning.folder, overrides, [tuning.trials[place].run for place in made], tuning.study.command)
    measurements = measure_sweep(sweep)
    answers, texts = compare_on_fresh_seed(tuning)
    texts = [*texts[:1], *filter(None, [scope_line(answers, [tuning.folder])]), *texts[1:]]
    compared = [Section("Default and tuned on a fresh seed", answer_blocks(answers))] if answers else []
    sections, shown = [*compared, _what(trials)], None
    if trials.good:
        sections.append(history_section(trials))
        sections += [_front(trials)] if len(trials.objectives) > 1 else []
        runs = {
            place: open_run(sweep.outputs / "runs" / tuning.trials[place].run) for place in trials.best_by_objective()
        }
        sections += [_keys(trials), _chosen(trials, runs)]
        first = next(iter(runs))
        shown = cover(runs[first], f"The motion of trial {first}, the chosen one.")
    if len(trials.good) < len(tuning.trials):
        rows = [
            [str(place), trial.run[:8] or "–", trials.settings(place), trial.failure]
            for place, trial in enumerate(tuning.trials)
            if trial.failure
        ]
        sections.append(
            Section("Failed trials", (failed_table("trials", ["trial", "run", "values", "failure"], rows),))
        )
    sections += [
        *make_sections([caveats_section], Subject(measurements, ())),
        _all_runs(trials, sweep, made, measurements, folder),
        made_by(measurements, ("tuning", tuning.folder.name)),
    ]
    goals = " and ".join(f"{objective.direction} the {title(objective.metric)}" for objective in trials.objectives)
    return Document(
        title=f"Tuning to {goals}",
        subtitle=", ".join(tuning.study.overrides),
        abstract=literal("\n".join([*texts, _abstract(trials)])),
        sections=sections,
        date=max(measurements.provenance.get("made on", [""])),
        cover=shown,
        key_numbers=_key_numbers(trials),
    )


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
    return answers, [*texts[:1], *failed, drawn, *texts[1:]]


def _key_numbers(trials: Trials) -> list[tuple[str, str, str]]:
    """Return the number of trials, and the chosen value of each objective with the keys that give it."""
    count = len(trials.tuning.trials)
    failed = count - len(trials.good)
    numbers = [("trials", str(count), f"{failed} of them failed" if failed else "none failed")]
    for place, objectives in (trials.best_by_objective() if trials.good else {}).items():
        for objective in objectives:
            value = trials.tuning.trials[place].values[list(trials.objectives).index(objective)]
            chosen = f"trial {place}: {trials.settings(place)}"
            numbers.append((f"{title(objective.metric)}, chosen", quantity(value, objective.unit), chosen))
    return numbers


def summary_of_tuning(tuning: Tuning) -> str:
    """Return the choice of a tuning in a sentence; empty if no trial is good."""
    trials = Trials(tuning)
    if len(trials.best) > 1:
        return f"{len(trials.best)} trials are on the Pareto front."
    return "".join(f"Trial {place}: {trials.outcome(place)}, with {trials.settings(place)}." for place in trials.best)


def _abstract(trials: Trials) -> str:
    names = ", ".join(key.name for key in trials.keys)
    count = len(trials.tuning.trials)
    texts = [f"{count} trials over {names}; {count - len(trials.good)} of them failed."]
    chosen = summary_of_tuning(trials.tuning)
    texts += [f"Chosen is t{chosen[1:]}" if len(trials.best) == 1 else chosen, *at_ends(trials.tuning)]
    return " ".join(filter(None, texts))


def _what(trials: Trials) -> Section:
    rows = [
        [
            key_label(key),
            number(key.low),
            number(key.high),
            "logarithmic" if key.log else "linear",
            "any" if key.step is None and not key.integer else f"by {number(key.step or 1)}",
        ]
        for key in trials.keys
    ]
    study = trials.tuning.study
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
    failed = len(trials.tuning.trials) - len(trials.good)
    if failed:
        told = "They rank behind all others, so that the search keeps away from them; a separate section lists them."
        blocks.append(Notice("failure", f"{failed} of {len(trials.tuning.trials)} trials failed", told))
    return Section("What was tuned", blocks)


def history_section(trials: Trials) -> Section:
    """Return the history of each objective, with the chosen value so far."""
    numbers = np.arange(len(trials.tuning.trials), dtype=float)
    panels = []
    for index, objective in enumerate(trials.objectives):
        values = trials.values(index)
        drawn = trials.points("trials", numbers, values, trials.good)
        so_far = objective.sign * np.minimum.accumulate(objective.sign * drawn.y)
        series = [drawn, Series("chosen so far", drawn.x, so_far, "line")]
        panels.append(Panel("", "trial", _label(objective), series, y_log=spans_decades(drawn.y)))
    failed = len(numbers) - len(trials.good)
    without = f" {failed} failed trials have no point." if failed else ""
    return Section("History", [Curves(f"Each good trial, and the chosen value so far.{without}", panels)])


def _label(objective: Objective) -> str:
    return metric_label(objective.metric, objective.unit)


def _front(trials: Trials) -> Section:
    """Return the front, a figure for each pair of objectives, and its trials; of a long front some along all of it."""
    objectives, front = trials.objectives, trials.best
    panels = []
    for a, b in combinations(range(len(objectives)), 2):
        x, y = trials.values(a), trials.values(b)
        series = [trials.points("trials", x, y, trials.good), trials.points("front", x, y, front)]
        logs = spans_decades(x[trials.good]), spans_decades(y[trials.good])
        panels.append(Panel("", _label(objectives[a]), _label(objectives[b]), series, *logs))
    rows = []
    for place in (front[index] for index in spaced_indices(len(front), _MOST_ROWS)):
        found = trials.tuning.trials[place]
        values = zip(objectives, found.values, strict=True)
        settings = [number(found.params[key.name]) for key in trials.keys]
        rows.append([str(place), *(quantity(value, objective.unit) for objective, value in values), *settings])
    header = numbers("trial", *(title(each.metric) for each in objectives), *(key.name for key in trials.keys))
    text = (
        f"The front has {len(front)} of {len(trials.good)} good trials: none of them gets better in one objective "
        "without another getting worse."
    )
    blocks: list[ReportBlock] = [
        Text("Every objective chooses the same trial." if len(front) == 1 else text),
        Curves("Good trials and the Pareto front.", panels, columns=1 if len(objectives) == 2 else 2),
        Table("Trials on the front.", header, rows),
    ]
    return Section("Trade-off", blocks)


def _keys(trials: Trials) -> Section:
    panels = []
    for index, objective in enumerate(trials.objectives):
        y = trials.values(index)
        for key in trials.keys:
            x = trials.params(key)
            series = [trials.points("trials", x, y, trials.good), trials.points("chosen", x, y, trials.best)]
            limits, logs = (key.low, key.high), (key.log, spans_decades(y[trials.good]))
            panels.append(Panel("", key_label(key), _label(objective), series, *logs, limits))
    return Section("Keys", [Curves("Good trials over the range of each key.", panels), _importance(trials)])


def _importance(trials: Trials) -> ReportBlock:
    from runner.sweeps.tuning.sampler import importances  # imports Optuna

    found = [
        importances(trials.keys, trials.tuning.trials, objective, place)
        for place, objective in enumerate(trials.objectives)
    ]
    if not all(found):
        return Text("Of fewer than 20 good trials it cannot be said which key matters.")
    rows = [[key.name, *(f"{100 * shares[key.name]:.0f} %" for shares in found)] for key in trials.keys]
    caption = (
        "Importance of the keys: how far the values of each in the leading tenth of the good trials differ from those "
        "among all of them, in shares (PED-ANOVA). Where trials crowd, it says what still decides there."
    )
    return Table(caption, ["key", *numbers(*(title(objective.metric) for objective in trials.objectives))], rows)


def _chosen(trials: Trials, runs: dict[int, Run]) -> Section:
    one = len(trials.objectives) == 1
    sections = []
    for place, objectives in trials.best_by_objective().items():
        best_in = ", ".join(f"{objective.direction} the {title(objective.metric)}" for objective in objectives)
        head = f"Trial {place}" if one else f"Trial {place}: {best_in}"
        sections.append(Section(head, _trial(trials, place, runs[place])))
    return Section("Chosen trial" if one else "Chosen by each objective", (), sections)


def _trial(trials: Trials, place: int, run: Run) -> list[ReportBlock]:
    params = trials.tuning.trials[place].params
    rows = [
        [key_label(key), number(params[key.name]), f"{number(key.low)} to {number(key.high)}"] for key in trials.keys
    ]
    goals = [objective.metric for objective in trials.objectives]
    names = dict.fromkeys([*goals, *(name for name in run.metrics if name in units())])
    metrics = [[title(name), run.metrics[name].text] for name in names]
    told = "Medians, in brackets smallest and largest over the repetitions."
    return [
        Table("Tuned keys.", ["key", *numbers("value", "range")], rows, Origin(command=trials.command(place))),
        *motion_blocks([Level("", [run], 0)]),
        Table(told, ["metric", *numbers("value")], metrics),
    ]


def _all_runs(trials: Trials, sweep: Sweep, made: list[int], measurements: Measurements, folder: Path) -> Section:
    goals = [objective.metric for objective in trials.objectives if objective.metric in measurements.values]
    metrics = [(name, measurements.units[name], measurements.medians(name)) for name in measurements.values]
    columns = [
        ("trial", "1", np.array(made, dtype=float)),
        *(next(column for column in metrics if column[0] == name) for name in goals),
        *((key.name, key.unit, trials.params(key)[made]) for key in trials.keys),
        *(column for column in metrics if column[0] not in goals),
    ]
    address = f"{os.path.relpath(sweep.outputs / 'runs', folder)}/"
    failures = [trials.tuning.trials[place].failure for place in made]
    caption = "All runs, in the order of the trials; medians of each."
    text = Text("In the HTML report a click on a point, here or in any figure, shows its run.")
    return Section("All runs", (text, list_runs(sweep, caption, range(len(made)), columns, failures, address)))
