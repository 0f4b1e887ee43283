"""Runs of the benchmark of laws with errors that are known: recorded runs with made-up metrics."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from support.study_plans import benchmark_kind

from runner.store import Run

SEEDS = 32  # of halves of 16, Holm's correction leaves something
SCATTER = np.random.default_rng(5).uniform(0.8, 1.25, SEEDS)  # what all laws of a seed have in common
# Sizes of the errors of the laws below in a whole plan, in mm.
SIZES = {
    "exact": (0.22, 0.221, 0.3, 4.4, 4.6, 0.28, 0.27, 0.25, 0.24, 4.5),
    "masses": (1.0, 1.01, 0.6, 4.0, 4.2, 1.6, 0.9, 0.8, 0.5, 4.4),
    "friction": (2.4, 2.4, 0.9, 3.6, 3.5, 1.0, 0.8, 0.7, 0.4, 3.4),
    "encoders": (1.0, 1.02, 1.3, 2.0, 2.1, 1.03, 0.98, 1.5, 1.1, 2.2),
    "limits_150": (0.22,) * 10,
    "limits_110": (0.24,) * 10,
    "limits_80": (0.9,) * 10,
    "delay_2": (np.nan,) * 10,
    "all": (1.9, 2.0, 1.5, 3.0, 2.9, 1.8, 1.7, 1.6, 1.0, 2.8),
}
LAWS = ("operational_space", "computed_torque", "with_integral", "joint_pd", "joint_pid", "passivity", "sliding_mode",
        "adaptive", "observed", "observed_pd")  # fmt: skip
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
    return SIZES[condition][LAWS.index(law)]
