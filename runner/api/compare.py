"""Runs or sweeps compared with each other, and comparisons as a table."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from runner import store
from runner.api.boundary import public
from runner.api.run import Run
from runner.api.sweep import Sweep
from runner.base.errors import RunnerError
from runner.reporting.answers import Asked, judge
from runner.reporting.comparison.operand import letter
from runner.store.latest import find_folder

if TYPE_CHECKING:
    import pandas as pd

    from runner.reporting.comparison.operand import Side

Comparable = Run | Sweep | str | Path


@public
def compare(
    first: Comparable, second: Comparable, *others: Comparable, metrics: str | Sequence[str] = ()
) -> "pd.DataFrame":
    """Compare runs, or sweeps, with the first of them: the statistics that `runner compare` prints.

    The repetitions of equal seeds are compared in pairs, and sweeps in the cells that both have. The columns are first
    and second, which are A for the first argument, B for the second and so on, then those of `Sweep.compare`.

        >>> common = ("robot=macro", "noise=thesis", "duration=0.1", "repetitions=6")
        >>> runs = [runner.run(*common, controller__damping_ratio=ratio) for ratio in (1.0, 0.7)]
        >>> runner.compare(*runs, metrics="peak_torque")[["first", "second", "metric", "n"]].values.tolist()
        [['A', 'B', 'peak_torque', 6]]

    Args:
        first: A run or a sweep, or its folder.
        second: Another one of the same sort.
        others: More of them.
        metrics: Names of metrics; empty for all shared metrics.

    Raises:
        RunnerError: if runs and sweeps are mixed, if two share no seed, cell or metric, or if one is damaged.
    """
    import pandas as pd

    from runner.reporting.comparison.sweeps import compare_sweeps
    from runner.reporting.sweep.subject import first_screen, whole_metrics

    things = [_opened(thing) for thing in (first, second, *others)]
    if len({type(thing) for thing in things}) > 1:
        raise RunnerError("runs and sweeps cannot be compared with each other; give only runs or only sweeps")
    names = [metrics] if isinstance(metrics, str) else metrics
    one, *rest = [_side(letter(place), thing) for place, thing in enumerate(things)]
    frames = []
    for side in rest:
        pooled = compare_sweeps(one, side, names).pooled
        screen = first_screen(names or whole_metrics([found.metric for found in pooled]))
        labels = [{"first": one.name, "second": side.name}] * len(pooled)
        frames.append(comparison_frame(labels, pooled, screen))
    return pd.concat(frames, ignore_index=True)


def _opened(thing: Comparable) -> Run | Sweep:
    if isinstance(thing, Run | Sweep):
        return thing
    folder = find_folder(thing, ("run", "sweep"))
    return Sweep(store.open_sweep(folder)) if store.is_sweep(folder) else Run(store.open_run(folder))


def _side(name: str, thing: Run | Sweep) -> "Side":
    from runner.reporting.comparison.operand import open_side, side_of_run, stored_part
    from runner.sweeps.finer_step import work_out, work_out_sweep

    if isinstance(thing, Run):
        work_out(thing.folder.parent.parent, [thing.stored])
        return side_of_run(name, thing.stored)
    work_out_sweep(stored_part(thing.stored)[0])
    side = open_side(name, thing.folder)
    if side.damage:
        raise RunnerError("; ".join(side.damage))
    return side


def comparison_frame(
    labels: Sequence[Mapping[str, str]], asked: Sequence[Asked], first: Sequence[str]
) -> "pd.DataFrame":
    """Return a row for each comparison of one question, with its corrected p, its interval and its word.

    Args:
        labels: Names of the things compared in each row: the columns first and second, behind the axes.
        asked: The comparisons, in the same order.
        first: Metrics of the first screen; see judge.
    """
    import pandas as pd

    missing = (np.nan, np.nan)
    rows = [
        {
            **label,
            "metric": answer.metric,
            "unit": answer.unit,
            "difference": answer.comparison.difference,
            "low": (answer.interval or missing)[0],
            "high": (answer.interval or missing)[1],
            "n": answer.comparison.n,
            "effect": answer.comparison.effect,
            "p": answer.p_value,
            "word": answer.word,
        }
        for label, answer in zip(labels, judge(asked, first), strict=True)
    ]
    return pd.DataFrame(rows).astype({"low": float, "high": float, "p": float})
