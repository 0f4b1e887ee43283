"""Effect of null-space motion on the tip, the joints and the manipulability of the arm."""

from collections.abc import Callable, Mapping

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.reporting.document import Series
from runner.reporting.figures import columns, joint_columns, model_of
from runner.store import Run
from runner.study.measured import Measured
from runner.study.prose.patterns import called, found
from runner.study.prose.signals import manipulability
from runner.study.run_values import Signal, clock, trace_of

_ASIDE = [2, 4]  # the joints that lead the elbow out of the arm's vertical plane
_ELBOW = 4  # the one of them that shows it


def commands(run: Run) -> float:
    """Return how often a run's law commands, in Hz."""
    return 1.0 / float(run.config["controller"]["period"])


def travel(run: Run) -> float:
    """Return how far the joints have gone at the end: the largest of them, in rad."""
    q = joint_columns(run.trace(), "q")
    return float(np.abs(q[-1] - q[0]).max())


def way(run: Run) -> FloatArray:
    """Return the distance of the tip from where it began, shape (T,), in m."""
    tip = columns(run.trace(), "tip")
    return np.asarray(np.linalg.norm(tip - tip[0], axis=1))


def farthest_at(run: Run) -> float:
    """Return when that is largest, in s."""
    return float(clock(run)[int(np.argmax(way(run)))])


def between_commands(run: Run) -> float | None:
    """Return the largest of these distances half way between commands, in m; None where servos move the joints.

    Where none do, the joints move evenly from one command to the next.
    """
    if run.config["plant"]["kind"] != "kinematic":
        return None
    model, q = model_of(run), joint_columns(run.trace(), "q")
    between = model.tip_positions(0.5 * (q[1:] + q[:-1]))
    return float(np.linalg.norm(between - columns(run.trace(), "tip")[0], axis=1).max(initial=0.0))


def drifts(run: Run) -> FloatArray:
    """Return how far the joints are from where they were a cycle before, after each, shape (cycles,), in rad."""
    return np.asarray(np.linalg.norm(np.diff(joint_columns(run.trace(), "q")[:: _cycle(run)], axis=0), axis=1))


def _cycle(run: Run) -> int:
    """Return the ticks of a cycle."""
    return round(float(run.config["trajectory"]["duration"]) / float(run.config["controller"]["period"]))


def first_drift(run: Run) -> float | None:
    """Return the first of the drifts, in rad; None where no cycle is whole."""
    return next(iter(drifts(run)), None)


def last_drift(run: Run) -> float | None:
    """Return the last of them, likewise."""
    return next(reversed(drifts(run)), None)


def drift_in_all(run: Run) -> float:
    """Return their sum, in rad."""
    return float(drifts(run).sum())


def way_from_the_start(run: Run) -> float:
    """Return how far the joints are in the end from where they began, in rad."""
    q = joint_columns(run.trace(), "q")
    return float(np.linalg.norm(q[-1] - q[0]))


def drift_by_cycle(runs: Mapping[str, Run], pattern: str) -> list[Series]:
    """Return the drifts over the cycles, of each null-space task that a pattern stands for."""
    drift = {called("{task}", one.levels, {}): drifts(one.run) for one in found(runs, pattern)}
    return [Series(task, np.arange(1.0, own.size + 1.0), own, "points_line") for task, own in drift.items()]


def in_last_cycle(signal: Signal) -> Callable[[Run], FloatArray]:
    """Return a signal of the last cycle alone."""
    return lambda run: trace_of(signal, run)[max(len(run.trace()) - _cycle(run) - 1, 0) :]


def least_at_last(signal: Signal) -> Callable[[Run], float]:
    """Return the least value of a signal in the last cycle."""
    return lambda run: float(in_last_cycle(signal)(run).min())


def range_of_w(run: Run) -> str:
    """Return the least and the largest manipulability there, as a cell of a table."""
    w = in_last_cycle(manipulability)(run)
    return f"{number(float(w.min()))} to {number(float(w.max()))}"


def gain(sought: Measured, plain: Measured) -> Measured:
    """Return by how much a value is larger than another, in per cent."""
    share = sought / plain
    return Measured(f"gain of {share.name}", None if share.value is None else 100.0 * (share.value - 1.0), "%")


def aside(run: Run) -> float:
    """Return how far the joints that lead the elbow out of the arm's vertical plane are from zero at the start."""
    return float(np.abs(joint_columns(run.trace(), "q")[0, _ASIDE]).max())


def elbow_way(run: Run) -> float:
    """Return how far the elbow has turned out of the plane in the end, in rad."""
    return float(_elbow(run)[-1])


def elbow_half_way(run: Run) -> float:
    """Return when it has gone half of that, in s."""
    return float(clock(run)[int(np.argmax(_elbow(run) > 0.5 * elbow_way(run)))])


def _elbow(run: Run) -> FloatArray:
    q = joint_columns(run.trace(), "q")[:, _ELBOW]
    return np.asarray(np.abs(q - q[0]))
