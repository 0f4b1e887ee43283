"""Comparison of runs or sweeps with each other, as a table."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runner import store
from runner.api.boundary import public
from runner.api.run import Run
from runner.api.sweep import Sweep
from runner.base.errors import RunnerError
from runner.store.kinds import find_folder

if TYPE_CHECKING:
    import pandas as pd

Comparable = Run | Sweep | str | Path


@public
def compare(
    first: Comparable, second: Comparable, *others: Comparable, metrics: str | Sequence[str] = ()
) -> "pd.DataFrame":
    """Compare runs or sweeps with the first of them, and return the statistics that `runner compare` prints.

    Repetitions with equal seeds are compared in pairs. Sweeps are compared in the cells that both have. The columns are
    first and second (A for the first argument, B for the second and so on), then those of `Sweep.compare`.

        >>> common = ("robot=macro", "noise=thesis", "duration=0.1", "repetitions=6")
        >>> runs = [runner.run(*common, controller__damping_ratio=ratio) for ratio in (1.0, 0.7)]
        >>> runner.compare(*runs, metrics="peak_torque")[["first", "second", "metric", "n"]].values.tolist()
        [['A', 'B', 'peak_torque', 6]]

    Args:
        first: A run or a sweep, or its folder.
        second: Another run or sweep, of the same kind.
        others: More runs or sweeps of that kind.
        metrics: Names of metrics; empty for all shared metrics.

    Raises:
        RunnerError: if runs and sweeps are mixed, if two share no seed, cell or metric, or if one is damaged.
    """
    from runner.reporting.comparison.sweeps import answer_frame, compare_sweeps, measure_compared

    things = [thing if isinstance(thing, Run | Sweep) else store.open_stored(find_folder(thing, ("run", "sweep")))
              for thing in (first, second, *others)]  # fmt: skip
    runs = [thing for thing in things if isinstance(thing, store.Run)]
    sweeps = [thing for thing in things if isinstance(thing, store.Sweep)]
    if runs and sweeps:
        raise RunnerError("runs and sweeps cannot be compared with each other; give only runs or only sweeps")
    one, *rest = sides = measure_compared(runs or sweeps)
    if damage := [text for side in sides for text in side.damage]:
        raise RunnerError("; ".join(damage))
    names = [metrics] if isinstance(metrics, str) else metrics
    return answer_frame([answer for side in rest for answer in compare_sweeps(one, side, names).answers])
