"""Pareto front of a tuning with several objectives."""

from itertools import combinations

from runner.base.quantities import quantity
from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.markup import literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import spans_decades
from runner.reporting.tuning.subject import Subject, key_value, label

_MOST_ROWS = 20


def section(subject: Subject) -> Section:
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
        _table(subject),
    ]
    return Section("Trade-off", blocks)


def _table(subject: Subject) -> Table:
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
