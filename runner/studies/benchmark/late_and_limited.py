"""Effects of delay and torque limits in the benchmark."""

import numpy as np
from scipy.optimize import brentq

from runner.reporting.charts.figure import Map
from runner.reporting.document import Maps
from runner.reporting.words import in_words
from runner.store import Run
from runner.studies.benchmark.cells import UNTUNED, tuned
from runner.studies.benchmark.figures import any_origin, ratio, typical
from runner.studies.benchmark.made import ARMS, CONDITIONS, arms_of, laws_of, one_cell
from runner.study.measured import Measured
from runner.study.results import Runs, found

_LIMITED = {"limits_150": 1.5, "limits_110": 1.1, "limits_80": 0.8}


def over_condition(runs: Runs, condition: str, other: str, law: str) -> list[Measured]:
    """Return the error of a law under a condition over that under another one, on all arms."""
    return [
        Measured(
            f"error of {in_words(law)}, {CONDITIONS[condition]}, over {CONDITIONS[other]}, {ARMS[arm]}",
            ratio(*(one_cell(runs, arm, each).entry(law) for each in (condition, other))),
        )
        for arm in arms_of(runs)
    ]


def frequency_times_period(runs: Runs, arm: str) -> Measured:
    """Return the natural frequency of an arm's untuned gains times its period."""
    one_cell(runs, arm, "delay_2")  # tells where there is none
    (run, *_) = (one.run for one in found(runs, f"first/{arm}/computed_torque/{{task}}/delay_2/{UNTUNED[0]}"))
    own = run.config["controller"]
    return Measured(f"natural frequency times period, {ARMS[arm]}", own["natural_frequency"] * own["period"])


def bearable(ticks: int) -> Measured:
    """Return the natural frequency times the period at which position and velocity feedback becomes unstable.

    The loop is a mass under F = -omega^2 x - 2 omega v, held for a period h, and late by some ticks; its states are
    x, v h and the forces on the way.

    Args:
        ticks: The delay.
    """

    def beyond(a: float) -> float:
        step = np.eye(2 + ticks, k=1)  # each force moves up by a tick, to the first of them
        step[:2] = 0.0
        step[:2, :2] = [[1.0, 1.0], [0.0, 1.0]]
        law, moved = np.zeros(2 + ticks), np.array([0.5, 1.0])
        law[:2] = -(a**2), -2.0 * a
        if ticks:
            step[:2, 2], step[-1] = moved, law
        else:
            step[:2] += np.outer(moved, law)
        return float(np.abs(np.linalg.eigvals(step)).max() - 1.0)

    return Measured(f"stable with {ticks} ticks of delay", float(brentq(beyond, 0.1, 1.5)))


def limits_over_need(runs: Runs) -> list[Measured]:
    """Return each joint's torque limit over the share that it is to be of what the motions need, on all arms."""
    told = []
    for arm in arms_of(runs):
        peaks = [_peaks(one.run) for one in found(runs, f"first/{arm}/computed_torque/{{task}}/exact/{UNTUNED[0]}")]
        for condition, share in _LIMITED.items():
            one_cell(runs, arm, condition)  # tells where there are none
            limited = found(runs, f"first/{arm}/computed_torque/{{task}}/{condition}/{UNTUNED[0]}")
            for number, limit in enumerate(limited[0].run.config["torque_limits"]["max"]):
                need = [own[number] for own in peaks if own]
                value = limit / (share * max(need)) if len(need) == len(peaks) else None
                told.append(
                    Measured(f"limit over need, {ARMS[arm]}, {CONDITIONS[condition]}, joint {number + 1}", value)
                )
    return told


def saturated(runs: Runs, caption: str) -> Maps:
    """Return the ticks with a joint at its torque limit, in per cent, as one map for each arm."""
    panels = []
    for arm in arms_of(runs):
        laws = laws_of(runs, arm)[::-1]
        one_cell(runs, arm, next(iter(_LIMITED)))  # tells where there are none
        shares = [[_at_limit(runs, arm, law, condition) for condition in _LIMITED] for law in laws]
        names = [CONDITIONS[name] for name in _LIMITED]
        values = 100.0 * np.array(shares)
        panels.append(Map(ARMS[arm], "", "", names, list(map(in_words, laws)), values, np.zeros(values.shape, bool)))
    return Maps(caption, "ticks at a limit (%)", panels, False, 1, any_origin(runs))


def _peaks(run: Run) -> list[float]:
    """Return the peak torque of each joint; none of a run that failed."""
    found = [metric.median for name, metric in run.metrics.items() if name.startswith("peak_torque_")]
    return [peak for peak in found if peak is not None]


def _at_limit(runs: Runs, arm: str, law: str, condition: str) -> float:
    return float(np.mean([typical(runs, arm, law, condition, own, "saturation_fraction") for own in tuned(runs)]))
