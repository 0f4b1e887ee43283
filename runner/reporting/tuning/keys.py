"""Objectives over each tuned key, and the importance of the keys."""

import numpy as np

from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.markup import literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import spans_decades
from runner.reporting.tuning.subject import Subject, key_label, label
from runner.sweeps.tuning.sampler import importances


def section(subject: Subject) -> Section:
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
                Panel("", key_label(key), label(objective), series, key.log, spans_decades(y), (key.low, key.high))
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
