"""Question of stored results that a challenge asks again: that of a sweep, of two sweeps or runs, or of a tuning."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from runner.base.errors import RunnerError
from runner.base.quantities import ROUNDING
from runner.reporting.answers import Answer
from runner.reporting.comparison.pairs import label_text
from runner.reporting.comparison.sweeps import compare_levels, compare_runs, compare_sweeps, measure_compared
from runner.reporting.sweep.subject import choose, main_metrics
from runner.statistics.conclusion import larger_median
from runner.store.axes import axes_of, find_axis
from runner.store.finished import Finished
from runner.store.kinds import kind_of, outputs_of
from runner.store.opening import open_stored
from runner.store.run import Run
from runner.store.sweep import Sweep
from runner.sweeps.challenge.case import own_overrides
from runner.sweeps.challenge.question import Question, Side
from runner.sweeps.finer_step import work_out_sweep
from runner.sweeps.measurements import Measurements, check_metrics, limit_sweep, measure_sweep
from runner.sweeps.question import find_question
from runner.sweeps.tuning.study import open_tuning

Sides = tuple[tuple[str, Run], tuple[str, Run]]


def read_question(folders: Sequence[Path], by: str = "", metric: str = "", where: Sequence[str] = ()) -> Question:
    """Return the question of stored results.

    Args:
        folders: One sweep, one tuning, two sweeps or two runs.
        by: Axis whose levels are compared, for one sweep; empty for its question.
        metric: The metric; empty for the first one of the results.
        where: Values of keys that the cells have, each as KEY=VALUE.

    Raises:
        RunnerError: if the results have no comparison, or do not fit together.
    """
    kinds = [kind_of(folder) for folder in folders]
    if len(folders) > 2 or (by and (len(folders) > 1 or kinds[0] != "sweep")):
        raise RunnerError("challenge: not for these results. Allowed: one sweep with --by AXIS, or two results.")
    if kinds == ["tuning"]:
        return _of_tuning(folders[0], metric)
    things = [open_stored(folder) for folder in folders]
    sweeps = [limit_sweep(thing, where) for thing in things if isinstance(thing, Sweep)]
    runs = [thing for thing in things if isinstance(thing, Run)]
    if len(sweeps) == len(folders) == 1:
        return _of_sweep(sweeps[0], by, metric)
    if len(folders) == 2 and len(sweeps) == 2:
        return _of_two(sweeps, metric, folders)
    if len(folders) == 2 and len(runs) == 2:
        return _of_runs((("A", runs[0]), ("B", runs[1])), metric, folders)
    raise RunnerError(f"{folders[0]}: no comparison. Allowed: a sweep, a tuning, two sweeps or two runs.")


def _of_sweep(sweep: Sweep, by: str, metric: str) -> Question:
    axes = axes_of(sweep.overrides)[0]
    chosen = find_axis(axes, by, "--by") if by else find_question(axes, sweep.question)
    if chosen is None:
        raise RunnerError(f"{sweep.folder}: a sweep over conditions only. Allowed: --by AXIS.")
    if len(chosen.values) < 2:
        raise RunnerError(f"--by: {chosen.name} has one value. Allowed: an axis with two or more.")
    work_out_sweep(sweep)
    measured = measure_sweep(sweep)
    name = metric or next(iter(choose(measured).metrics), "")
    if not name:
        raise RunnerError(f"{sweep.folder}: no metric, because all runs failed. Allowed: a sweep with results.")
    check_metrics([name], measured.values)
    answers = compare_levels(measured, chosen.name, None, [name])
    finest = max(len(one.at) for one in answers)
    return _ask(_choose([one for one in answers if len(one.at) == finest]), answers, sweep.outputs, [sweep.folder])


def _of_two(sweeps: Sequence[Sweep], metric: str, folders: Sequence[Path]) -> Question:
    a, b = measure_compared(sweeps)
    name = metric or next(iter(main_metrics([a, b])), "")
    found = compare_sweeps(a, b, [name] if name else [])
    answers = [one for one in found.answers if one.metric == name]
    finest = max((len(one.at) for one in answers), default=0)
    return _ask(_choose([one for one in answers if len(one.at) == finest]), answers, sweeps[0].outputs, folders)


def _of_runs(sides: Sides, metric: str, folders: Sequence[Path]) -> Question:
    runs = [run for _, run in sides]
    a, b = measure_compared(runs)
    names = [metric] if metric else main_metrics([a, b])[:1]
    check_metrics(names, a.values)
    answers, why = compare_runs(replace(a, name=sides[0][0]), replace(b, name=sides[1][0]), names)
    if not answers:
        raise RunnerError(f"{folders[0]}: {why}. Allowed: two runs on the same seed with six repetitions or more.")
    return _ask(answers[0], answers, outputs_of(runs[0].folder), folders)


def _of_tuning(folder: Path, metric: str) -> Question:
    """Return the question of a tuning: the chosen trial against the default, on the fresh seed."""
    tuning = open_tuning(folder)
    if tuning.fresh is None:
        raise RunnerError(f"{folder}: its chosen trial is not compared with the default. Allowed: a finished tuning.")
    finished = Finished(outputs_of(folder))
    default, tuned = (finished.open(name) for name in (tuning.fresh.default, tuning.fresh.tuned))
    name = metric or tuning.study.objectives[0].metric
    return _of_runs((("default", default), (f"trial {tuning.fresh.trial}", tuned)), name, [folder])


def _choose(answers: Sequence[Answer]) -> Answer:
    """Return the first answer with a sign in the first condition, else the first answer there."""
    here = [one for one in answers if one.at == answers[0].at]
    return next((one for one in here if one.sign), here[0])


def _ask(one: Answer, answers: Sequence[Answer], outputs: Path, folders: Sequence[Path]) -> Question:
    """Return the question behind an answer; of several cells in a condition the first one."""
    pairs, found = one.pairs, one.comparison
    if pairs is None:
        raise RunnerError(f"{folders[0]}: no comparison. Allowed: a sweep, a tuning, two sweeps or two runs.")
    if one.limit:
        raise RunnerError(f"{one.metric}: not compared, because {one.limit}. Allowed: another metric by --metrics.")
    finished = Finished(outputs)
    cells = [(pairs.a, int(pairs.of_a[0])), (pairs.b, int(pairs.of_b[0]))]
    runs = [finished.open(side.hashes[cell]) for side, cell in cells]
    seeds = [int(seed) for side, _ in cells for seed in np.asarray(side.seeds).tolist()] or [
        int(run.config["seed"]) for run in runs
    ]
    sides = [
        Side(name, own_overrides(run.overrides), _medians(side, cell))
        for name, run, (side, cell) in zip(one.full_names, runs, cells, strict=True)
    ]
    size = found.difference / (1.0 if "fraction" in one.metric else max(larger_median(found), ROUNDING))
    conditions = list(dict.fromkeys(label_text(other.at) for other in answers if len(other.at) == len(one.at)))
    return Question(
        one.metric,
        one.unit,
        (sides[0], sides[1]),
        one.sign,
        size if np.isfinite(size) else None,
        None if found.error is None or not np.isfinite(found.error) else found.error,
        max(seeds) + 1,
        label_text(one.at) if one.at else "",
        len(conditions) - 1,
        tuple(folder.resolve() for folder in runs[0].config_dirs),
        [str(folder.resolve().name) for folder in folders],
    )


def _medians(side: Measurements, cell: int) -> dict[str, float]:
    """Return the finite medians of the metrics of a cell."""
    known = {name: float(side.medians(name)[cell]) for name in side.values}
    return {name: value for name, value in known.items() if np.isfinite(value)}
