"""Effect of null-space motion on the tip, the joints and the manipulability of the arm."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.studies.xarm7.figures import cycle_ticks, drifts
from runner.papers.study.run_values import Signal, trace_of
from runner.store import Run


def between_commands(run: Run) -> float | None:
    """Return the tip's largest way from its start half way between commands, in m; None if servos move the joints.

    If none do, the joints move evenly from one command to the next.
    """
    if run.config["plant"]["kind"] != "kinematic":
        return None
    model, q = run.model, run.joints("q")
    between = model.tip_positions(0.5 * (q[1:] + q[:-1]))
    return float(np.linalg.norm(between - run.vector("tip")[0], axis=1).max(initial=0.0))


def cycle_numbers(run: Run) -> FloatArray:
    """Return the numbers of the cycles from 1, shape (cycles,)."""
    return np.arange(1.0, len(drifts(run)) + 1.0)


def in_last_cycle(signal: Signal) -> Callable[[Run], FloatArray]:
    """Return the last cycle of a signal."""
    return lambda run: trace_of(signal, run)[max(len(run.t) - cycle_ticks(run) - 1, 0) :]


def elbow_half_way(run: Run) -> float:
    """Return when q5, which leads the elbow aside, has gone half of its way, in s."""
    way = np.abs(run.signal("q5") - run.signal("q5")[0])
    return float(run.t[int(np.argmax(way > 0.5 * way[-1]))])
