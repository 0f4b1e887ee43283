"""Runs of the benchmark of laws with errors that are known: recorded runs with made-up metrics."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from support.study_plans import benchmark_kind

from runner.store import Run

SEEDS = 32  # of halves of 16, Holm's correction leaves something
SCATTER = np.random.default_rng(5).uniform(0.8, 1.25, SEEDS)  # what all laws of a seed have in common
COLUMNS = ("exact", "masses", "friction", "encoders", "limits_150", "limits_110", "limits_80", "delay_2", "all")
# Sizes of the errors of each law of the study in a whole plan, in mm, by condition.
SIZES = {
    "operational_space": (0.22, 1.0, 2.4, 1.0, 0.22, 0.24, 0.9, np.nan, 1.9),
    "computed_torque": (0.221, 1.01, 2.4, 1.02, 0.22, 0.24, 0.9, np.nan, 2.0),
    "with_integral": (0.3, 0.6, 0.9, 1.3, 0.22, 0.24, 0.9, np.nan, 1.5),
    "joint_pd": (4.4, 4.0, 3.6, 2.0, 0.22, 0.24, 0.9, np.nan, 3.0),
    "joint_pid": (4.6, 4.2, 3.5, 2.1, 0.22, 0.24, 0.9, np.nan, 2.9),
    "passivity": (0.28, 1.6, 1.0, 1.03, 0.22, 0.24, 0.9, np.nan, 1.8),
    "sliding_mode": (0.27, 0.9, 0.8, 0.98, 0.22, 0.24, 0.9, np.nan, 1.7),
    "adaptive": (0.25, 0.8, 0.7, 1.5, 0.22, 0.24, 0.9, np.nan, 1.6),
    "observed": (0.24, 0.5, 0.4, 1.1, 0.22, 0.24, 0.9, np.nan, 1.0),
    "observed_pd": (4.5, 4.4, 3.4, 2.2, 0.22, 0.24, 0.9, np.nan, 2.8),
}
INTEGRATING = {"masses": 0.4, "encoders": 0.5}  # sizes for an integral once learned
LATER = {
    "friction": {"xarm7": 0.2, "panda": 0.2},
    "encoders": {"macro": 1.3},
}  # factors of adaptive control's, later on
NEEDS = {"macro": (234.0, 38.7, 8.74), "mini": (0.183, 0.222, 0.0868)}  # peak torques, N m
LEARNED = {"macro": 1.9, "planar": 0.3, "xarm7": 0.3}  # errors of iterative learning, mm
TUNINGS = {"1": 1.0, "2": 1.02, "untuned": 2.2}  # factors of their errors
CHANGES = {"slow": 0.6, "fast": 2.5, "half": 1.05, "untuned": 2.2}  # factors of errors, with all wrong at once
_DRAWN = ("masses", "encoders", "all")  # conditions that differ from seed to seed


def benchmark_runs(names: Iterable[str], kinds: Mapping[str, Run]) -> dict[str, Run]:
    """Return runs of a plan by name, with errors of the sizes above.

    Args:
        names: Names of the runs.
        kinds: A run of each plan, arm and condition, by these.
    """
    return {name: _with_errors(name, kinds[benchmark_kind(name)]) for name in names}


def _with_errors(name: str, kind: Run) -> Run:
    plan, arm, law, *task, condition, gains = [*name.split("/"), *(["untuned"] if "repeated" in name else [])]
    if plan == "changed":
        task, condition, gains, factor = [condition], "all", "1", CHANGES[gains]
    else:
        factor = TUNINGS[gains]
    size = 1e-3 * factor * _size(plan, arm, law, condition)
    errors = (size * (SCATTER if condition in _DRAWN else np.ones(1))).tolist()
    if (plan, law, task, gains) == ("first", "joint_pd", ["circle"], "untuned"):
        errors[: -(-len(errors) // 4)] = [None] * -(-len(errors) // 4)
    metrics = {
        "rms_tracking_error": _metric("m", None, values=errors),
        "torque_chatter": _metric("N m", 1e3 * size),
        "rms_torque": _metric("N m", 10.0),
        "rms_tracking_error_last_period": _metric("m", size),
    }
    if plan in ("learned", "changed"):
        later = LATER.get(condition, {}).get(arm, 1.0) if law == "adaptive" else 1.0
        for after, grown in ((4, 1.0), (8, later), (16, later)):
            values = [each if each is None else grown * each for each in errors]
            metrics[f"rms_tracking_error_period_{after}"] = _metric("m", None, values=values)
    metrics |= {f"peak_torque_q{joint}": _metric("N m", need) for joint, need in enumerate(NEEDS.get(arm, ()), 1)}
    record = {**kind.record, "metrics": metrics, "repetitions": len(errors)}
    return replace(kind, record=record, config={**kind.config, "repetitions": len(errors)})


def _metric(unit: str, median: float | None, **values: Any) -> dict[str, Any]:
    return {"unit": unit, "median": median, "min": median, "max": median, **values}


def _size(plan: str, arm: str, law: str, condition: str) -> float:
    if law == "iterative_learning":
        return LEARNED[arm]
    if plan == "learned" and law == "with_integral" and condition in INTEGRATING:
        return INTEGRATING[condition]
    return SIZES[law][COLUMNS.index(condition)]
