"""Functions for every chapter: values of stored runs, and common blocks.

If the first argument of a function is `runs`, the chapter reader inserts the runs of the study.
"""

import math
from collections.abc import Callable, Mapping, Sequence, Sized
from dataclasses import replace
from typing import Any

from runner.base.quantities import number, quantity
from runner.papers.study import run_values
from runner.papers.study.measured import Measured
from runner.papers.study.results import Runs, axes_of, called, matching_runs, other
from runner.papers.study.run_values import Signal, config_value, number_of
from runner.reporting import figures
from runner.reporting.document import Curves, Formula, Notice, Playback, ReportBlock
from runner.reporting.plant_step import describe_plant
from runner.reporting.words import PLANT
from runner.store import Run


def metric(runs: Runs, run: str, name: str, words: str = "", end: str = "median") -> Measured:
    """Return a metric of a run, with its unit: the median, or the "min" or "max" of its repetitions.

    Conditions call it by the words, or by run and name.
    """
    found = run_values.measured(runs[run], name, words or f"{name} of {run}")
    return replace(found, value=getattr(runs[run].metrics[name], end)) if name in runs[run].metrics else found


def percent(share: Measured) -> Measured:
    """Return a share in per cent."""
    return Measured(share.name, None if share.value is None else 100.0 * share.value, "%")


def round_to(value: Measured | float, digits: int) -> str:
    """Return a number, of a measured value with its unit, with `digits` digits."""
    return quantity(value.value, value.unit, digits) if isinstance(value, Measured) else number(value, digits)


def config(runs: Runs, run: str, key: str) -> Any:
    """Return a value of a run's config by its dotted key."""
    return config_value(runs[run], key)


def playback(runs: Runs, run: str, caption: str, end: float) -> Playback:
    """Return the motion of a run up to an instant, in s."""
    return figures.playback(runs[run], caption, end)


def desired_motion(
    runs: Runs, run: str, caption: str, number: str = "", axes: tuple[str, ...] = ("x", "y", "z")
) -> Curves:
    """Return the desired position, velocity and acceleration of a run's tip along some axes."""
    return figures.desired_motion(runs[run], caption, number, tuple(axes))


def failures(runs: Runs, prefix: str) -> list[ReportBlock]:
    """Return a notice that names the failed runs of those whose names begin so; nothing where none failed."""
    return run_values.failures({name: run for name, run in runs.items() if name.startswith(prefix)})


def plant_of(runs: Runs, run: str) -> str:
    """Return the name of a run's plant, such as "PyBullet", or "MuJoCo" where that one is missing."""
    kind: str = runs[run].config["plant"]["kind"]
    return PLANT.get(kind, kind)


def integration_error(runs: Runs, run: str, *metrics: str) -> str:
    """Return a run's plant, its step, and the error of the step in some metrics, in two sentences at most."""
    return describe_plant(runs[run], metrics)


def formula(typst: str, *, number: str = "") -> Formula:
    """Return a displayed equation in Typst mathematics, with its number in the source."""
    return Formula(typst, number)


def notice(title: str, text: str) -> Notice:
    """Return a warning: a limit of what is compared."""
    return Notice("warning", title, text)


def largest(name: str, *values: Measured) -> Measured:
    """Return the largest of some measured values under a new name; without a value if one of them has none."""
    return _extreme(max, name, values)


def smallest(name: str, *values: Measured) -> Measured:
    """Return the smallest of some measured values under a new name; see `largest`."""
    return _extreme(min, name, values)


def of_run(
    runs: Runs,
    words: str,
    what: Callable[..., float | None],
    unit: str,
    *names: str,
    though_failed: bool = False,
) -> Measured:
    """Return the value of a function of a run, or of some, as a measured value that conditions call by words.

    The names may have axes in braces. A failed run has no value, unless what a function reads of it until it failed is
    asked for.
    """
    chosen = _chosen(runs, names)
    left_out = not though_failed and any(run.status == "failed" for run in chosen)
    return Measured(words, None if left_out else what(*chosen), unit)


def value_of(runs: Runs, what: Callable[..., Any], *names: str) -> Any:
    """Return the value of a function for a run, or for those that names with axes stand for, failed or not."""
    return what(*_chosen(runs, names))


def how_many(values: Sized) -> int:
    """Return the number of values."""
    return len(values)


def named(words: str, value: float | None, unit: str = "1") -> Measured:
    """Return a number as a measured value, which conditions call by the words."""
    return Measured(words, value, unit)


def each(
    runs: Runs,
    words: str,
    what: Signal,
    unit: str,
    *patterns: str,
    only: Callable[[Run], bool] | None = None,
    levels: Mapping[str, str] | None = None,
    others: Sequence[str] = (),
) -> list[Measured]:
    """Return a metric, or what a function gives, of each run that patterns stand for; see of_run and largest.

    The words have axes in braces; without any, the name of the run follows them. `only` selects the runs for
    which this function is true. `levels` has words for levels of the axes. `others` names further runs, which the
    function gets, too.
    """
    return [
        Measured(
            called(words, one.levels, levels or {}) if axes_of(words) else f"{words} of {one.name}",
            None
            if one.run.status == "failed"
            else number_of(what, one.run, *(other(runs, twin, one.levels) for twin in others)),
            unit,
        )
        for pattern in patterns
        for one in matching_runs(runs, pattern)
        if only is None or only(one.run)
    ]


def count(runs: Runs, words: str, what: Callable[..., bool] | None, *patterns: str) -> Measured:
    """Return of how many runs that patterns stand for a function is true, or with none how many there are."""
    return Measured(words, sum(bool(what(run)) if what else True for run in _chosen(runs, patterns)))


def _chosen(runs: Runs, patterns: Sequence[str]) -> list[Run]:
    return [one.run for pattern in patterns for one in matching_runs(runs, pattern)]


def _extreme(chosen: Callable[[list[float]], float], name: str, values: Sequence[Measured]) -> Measured:
    known = [each.value for each in values if each.value is not None and not math.isnan(each.value)]
    value = chosen(known) if len(known) == len(values) and known else None
    return Measured(name, value, values[0].unit if values else "1", tuple(values))
