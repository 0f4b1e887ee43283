"""Effect of null-space motion on the tip, the joints and the manipulability of the arm."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.reporting.document import Series
from runner.store import Run
from runner.study.measured import Measured
from runner.study.prose.signals import manipulability
from runner.study.results import Runs, called, found
from runner.study.run_values import Signal, trace_of

_ASIDE = [2, 4]  # the joints that lead the elbow out of the arm's vertical plane
_ELBOW = 4  # the one of them that shows it


def between_commands(run: Run) -> float | None:
    """Return the largest of these distances half way between commands, in m; None where servos move the joints.

    If none do, the joints move evenly from one command to the next.
    """
    if run.config["plant"]["kind"] != "kinematic":
        return None
    model, q = run.model, run.joints("q")
    between = model.tip_positions(0.5 * (q[1:] + q[:-1]))
    return float(np.linalg.norm(between - run.vector("tip")[0], axis=1).max(initial=0.0))


def drifts(run: Run) -> FloatArray:
    """Return the joints' displacement over each cycle, shape (cycles,), in rad."""
    return np.asarray(np.linalg.norm(np.diff(run.joints("q")[:: _cycle(run)], axis=0), axis=1))


def _cycle(run: Run) -> int:
    """Return the ticks of a cycle."""
    return round(float(run.config["trajectory"]["duration"]) / float(run.config["controller"]["period"]))


def drift_by_cycle(runs: Runs, pattern: str) -> list[Series]:
    """Return the drifts over the cycles, of each null-space task that a pattern stands for."""
    drift = {called("{task}", one.levels, {}): drifts(one.run) for one in found(runs, pattern)}
    return [Series(task, np.arange(1.0, own.size + 1.0), own, "points_line") for task, own in drift.items()]


def in_last_cycle(signal: Signal) -> Callable[[Run], FloatArray]:
    """Return the last cycle of a signal."""
    return lambda run: trace_of(signal, run)[max(len(run.t) - _cycle(run) - 1, 0) :]


def range_of_w(run: Run) -> str:
    """Return the least and the largest manipulability there, as a cell of a table."""
    w = in_last_cycle(manipulability)(run)
    return f"{number(float(w.min()))} to {number(float(w.max()))}"


def gain(sought: Measured, plain: Measured) -> Measured:
    """Return by how much a value is larger than another, in per cent."""
    share = sought / plain
    return Measured(f"gain of {share.name}", None if share.value is None else 100.0 * (share.value - 1.0), "%")


def aside(run: Run) -> float:
    """Return the largest initial position of the joints that lead the elbow out of the arm's plane, in rad."""
    return float(np.abs(run.joints("q")[0, _ASIDE]).max())


def elbow_half_way(run: Run) -> float:
    """Return when it has gone half of that, in s."""
    return float(run.t[int(np.argmax(_elbow(run) > 0.5 * _elbow(run)[-1]))])


def _elbow(run: Run) -> FloatArray:
    q = run.joints("q")[:, _ELBOW]
    return np.asarray(np.abs(q - q[0]))
