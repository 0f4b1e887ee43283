"""Subject of a tuning report, and sections on its trials: history, keys, Pareto front and chosen trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number, quantity
from runner.plugins.metric_units import units
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.document import Block, Curves, Origin, Panel, Section, Series, Table, Text
from runner.reporting.figures import playback, torque_and_error
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import metric_label, title
from runner.reporting.sweep.subject import key_label, spans_decades
from runner.store import Run
from runner.sweeps.tuning.key import Key
from runner.sweeps.tuning.objective import Objective, Trial, best
from runner.sweeps.tuning.sampler import importances
from runner.sweeps.tuning.study import Tuning

_MOST_ROWS = 20


@dataclass(frozen=True)
class Subject:
    """A tuning as its report looks at it.

    Attributes:
        tuning: The tuning.
    """

    tuning: Tuning

    @property
    def keys(self) -> Sequence[Key]:
        """The tuned keys."""
        return self.tuning.study.keys

    @property
    def objectives(self) -> Sequence[Objective]:
        """What was to get better."""
        return self.tuning.study.objectives

    @property
    def trials(self) -> Sequence[Trial]:
        """All trials, in order."""
        return self.tuning.trials

    @cached_property
    def good(self) -> list[int]:
        """Numbers of the trials that did not fail."""
        return [place for place, trial in enumerate(self.trials) if not trial.failure]

    @cached_property
    def best(self) -> list[int]:
        """Numbers of the best trials: one, or the Pareto front."""
        return best(self.trials, self.objectives)

    @cached_property
    def values(self) -> FloatArray:
        """Value of each objective in the good trials, shape (good, objectives)."""
        return np.array([self.trials[place].values for place in self.good]).reshape(len(self.good), -1)

    def hints(self, numbers: Sequence[int]) -> list[str]:
        """Return what a reader is told of some trials when pointing at them."""
        return [f"trial {place}: {self.settings(place)}; {self.outcome(place)}" for place in numbers]

    def runs(self, numbers: Sequence[int]) -> list[str]:
        """Return the hashes of some trials' runs."""
        return [self.trials[place].run for place in numbers]

    def settings(self, place: int) -> str:
        """Return the values of the keys in a trial."""
        params = self.trials[place].params
        return ", ".join(f"{key.name}={params[key.name]:.5g}" for key in self.keys)

    def outcome(self, place: int) -> str:
        """Return the values of the objectives in a good trial."""
        values = zip(self.objectives, self.trials[place].values, strict=True)
        return ", ".join(f"{title(objective.metric)} {quantity(value, objective.unit)}" for objective, value in values)

    def best_by_objective(self) -> dict[int, list[Objective]]:
        """Return the trials on the front that are best in an objective, with the objectives that each is best in."""
        found: dict[int, list[Objective]] = {}
        for index, objective in enumerate(self.objectives):
            losses = {place: objective.sign * self.trials[place].values[index] for place in self.best}
            found.setdefault(min(losses, key=losses.__getitem__), []).append(objective)
        return found


def label(objective: Objective) -> str:
    """Return the title of an objective's metric with its unit, as on the axis of a figure."""
    return metric_label(objective.metric, objective.unit)


def key_value(value: float) -> str:
    """Return the value of a key as text."""
    return number(value, 4)


def trials_section(subject: Subject, runs: Mapping[int, Run], commands: Mapping[int, str]) -> Section:
    """Return the trial that is best in each objective.

    Args:
        subject: The tuning.
        runs: The run of each of these trials.
        commands: The command that makes it.
    """
    one = len(subject.objectives) == 1
    sections = [
        _trial(subject, trial, [] if one else objectives, runs[trial], commands[trial])
        for trial, objectives in subject.best_by_objective().items()
    ]
    return Section("Chosen trial" if one else "Chosen by each objective", (), sections)


def _trial(subject: Subject, trial: int, objectives: Sequence[Objective], run: Run, command: str) -> Section:
    params = subject.trials[trial].params
    rows = [
        literals([key_label(key.name), key_value(params[key.name]), f"{key_value(key.low)} to {key_value(key.high)}"])
        for key in subject.keys
    ]
    goals = [objective.metric for objective in subject.objectives]
    names = dict.fromkeys([*goals, *(name for name in run.metrics if name in units())])
    metrics = [[literal(title(name)), run.metrics[name].text] for name in names]
    blocks: list[Block] = [
        Table("Tuned keys.", ["key", "value", "range"], rows, (1, 2), Origin(command=command)),
        torque_and_error(run, "Torque of each joint and tip position error, repetition 0."),
        playback(run, "The motion of repetition 0."),
        Table(
            "Medians, in brackets smallest and largest over the repetitions.",
            ["metric", "value"],
            metrics,
            (1,),
        ),
    ]
    best_in = ", ".join(f"{objective.direction} the {title(objective.metric)}" for objective in objectives)
    return Section(f"Trial {trial}" + (f": {best_in}" if best_in else ""), blocks)


def keys_section(subject: Subject) -> Section:
    """Return the objectives over each key, and the importance of the keys."""
    hints, runs = subject.hints(subject.good), subject.runs(subject.good)
    best_hints, best_runs = subject.hints(subject.best), subject.runs(subject.best)
    best = [subject.good.index(trial) for trial in subject.best]
    panels = []
    for index, objective in enumerate(subject.objectives):
        y = subject.values[:, index]
        for key in subject.keys:
            x = np.array([subject.trials[trial].params[key.name] for trial in subject.good], dtype=float)
            series = [
                Series("trials", x, y, "points", hints=hints, runs=runs),
                Series("chosen", x[best], y[best], "points", hints=best_hints, runs=best_runs),
            ]
            panels.append(
                Panel("", key_label(key.name), label(objective), series, key.log, spans_decades(y), (key.low, key.high))
            )
    return Section("Keys", [Curves("Good trials over the range of each key.", panels), _importance(subject)])


def _importance(subject: Subject) -> Block:
    found = [
        importances(subject.keys, subject.trials, objective, place)
        for place, objective in enumerate(subject.objectives)
    ]
    if not all(found):
        return Text("Of fewer than 20 good trials it cannot be said which key matters.")
    rows = [[key.name, *(f"{100 * shares[key.name]:.0f} %" for shares in found)] for key in subject.keys]
    caption = (
        "Importance of the keys: how far the values of each in the leading tenth of the good trials differ from those "
        "among all of them, in shares (PED-ANOVA). Where trials crowd, it says what still decides there."
    )
    header = ["key", *(title(objective.metric) for objective in subject.objectives)]
    return Table(caption, literals(header), [literals(row) for row in rows], tuple(range(1, len(header))))


def history_section(subject: Subject) -> Section:
    """Return the history of each objective, with the chosen value so far."""
    numbers = np.array(subject.good, dtype=float)
    hints, runs = subject.hints(subject.good), subject.runs(subject.good)
    panels = []
    for index, objective in enumerate(subject.objectives):
        values = subject.values[:, index]
        so_far = objective.sign * np.minimum.accumulate(objective.sign * values)
        series = [
            Series("trials", numbers, values, "points", hints=hints, runs=runs),
            Series("chosen so far", numbers, so_far, "line"),
        ]
        panels.append(Panel("", "trial", label(objective), series, y_log=spans_decades(values)))
    failed = len(subject.trials) - len(subject.good)
    without = f" {failed} failed trials have no point." if failed else ""
    return Section("History", [Curves(f"Each good trial, and the chosen value so far.{without}", panels)])


def front_section(subject: Subject) -> Section:
    """Return the front, a figure for each pair of objectives."""
    objectives, front = subject.objectives, subject.best
    places = [subject.good.index(trial) for trial in front]
    pair = len(objectives) == 2
    panels = []
    for a, b in combinations(range(len(objectives)), 2):
        x, y = subject.values[:, a], subject.values[:, b]
        of_all = Series("trials", x, y, "points", hints=subject.hints(subject.good), runs=subject.runs(subject.good))
        of_front = Series("front", x[places], y[places], "points", hints=subject.hints(front), runs=subject.runs(front))
        labels = label(objectives[a]), label(objectives[b])
        panels.append(Panel("", *labels, [of_all, of_front], spans_decades(x), spans_decades(y)))
    text = f"On the front stand {len(front)} of {len(subject.good)} good trials: none of them gets better in one "
    text += "objective without another getting worse."
    blocks: list[Block] = [
        Text("Every objective chooses the same trial." if len(front) == 1 else text),
        Curves("Good trials and the Pareto front.", panels, columns=1 if pair else 2),
        _front_table(subject),
    ]
    return Section("Trade-off", blocks)


def _front_table(subject: Subject) -> Table:
    # Of a long front, trials along the whole of it.
    rows = []
    for trial in (subject.best[place] for place in spaced_indices(len(subject.best), _MOST_ROWS)):
        found = subject.trials[trial]
        values = zip(subject.objectives, found.values, strict=True)
        settings = [key_value(found.params[key.name]) for key in subject.keys]
        rows.append([str(trial), *(quantity(value, objective.unit) for objective, value in values), *settings])
    header = [
        "trial",
        *(title(objective.metric) for objective in subject.objectives),
        *(key.name for key in subject.keys),
    ]
    return Table("Trials on the front.", literals(header), rows, tuple(range(len(header))))
