"""Best trials of a tuning: values, commands and motions."""

from collections.abc import Mapping, Sequence

from runner.base.quantities import spread
from runner.plugins.metric_units import units
from runner.reporting.document import Block, Origin, Section, Table
from runner.reporting.figures import playback, torque_and_error
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.tuning.subject import Subject, key_label, key_value
from runner.store import Run
from runner.sweeps.tuning.objective import Objective


def section(subject: Subject, runs: Mapping[int, Run], commands: Mapping[int, str]) -> Section:
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
        literals([key_label(key), key_value(params[key.name]), f"{key_value(key.low)} to {key_value(key.high)}"])
        for key in subject.keys
    ]
    goals = [objective.metric for objective in subject.objectives]
    names = dict.fromkeys([*goals, *(name for name in run.metrics if name in units())])
    metrics = [[literal(title(name)), spread(run.metrics[name])] for name in names]
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
