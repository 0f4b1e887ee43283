"""Convergence history of the objectives over the trials."""

import numpy as np

from runner.reporting.document import Curves, Panel, Section, Series
from runner.reporting.sweep.subject import spans_decades
from runner.reporting.tuning.subject import Subject, label


def section(subject: Subject) -> Section:
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
