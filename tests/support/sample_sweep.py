"""Sweeps that were never run, for the tests of their report."""

import itertools

import numpy as np

from runner.reporting.sweep.subject import Subject, choose
from runner.store.axes import Axis
from runner.sweeps.measurements import Measurements


def measurements(axes, metrics, failed=()):
    """Return a full grid; metrics are functions of the levels of a cell, which return the values of its repetitions."""
    levels = np.array(list(itertools.product(*(range(len(values)) for values in axes.values())))).reshape(-1, len(axes))
    cells = len(levels)
    found = {name: np.array([value(*level) for level in levels], dtype=float) for name, value in metrics.items()}
    for values in found.values():
        values[list(failed)] = np.inf
    return Measurements(
        axes=[Axis(name, values, levels[:, index]) for index, (name, values) in enumerate(axes.items())],
        fixed=["robot=macro"],
        hashes=[f"{cell:024x}" for cell in range(cells)],
        statuses=["failed" if cell in failed else "ok" for cell in range(cells)],
        failures=["diverged, at once" if cell in failed else "" for cell in range(cells)],
        units=dict.fromkeys(metrics, "m"),
        values=found,
        provenance={"made on": ["2026-11-21"], "plant": ["bullet, step 0.001 s"]},
    )


def noisy(function, repetitions=8, scatter=0.01):
    """Return a metric whose repetitions scatter about a function of the levels."""

    def values(*level):
        rng = np.random.default_rng([0, *map(int, level)])
        return function(*level) * np.exp(scatter * rng.normal(size=repetitions))

    return values


def two_axes(failed=(), **metrics) -> Subject:
    """Return a sweep over noise (3) and torque limit (4); its error is 2^noise * 3^-limit."""
    axes = {"noise.position": [1e-4, 1e-3, 1e-2], "torque_limits.max": [20.0, 40.0, 60.0, 80.0]}
    given = metrics or {
        "max_tracking_error": noisy(lambda noise, limit: 2.0**noise * 3.0**-limit),
        "peak_torque": noisy(lambda noise, limit: 20.0 * (1 + limit), scatter=0.0),
    }
    return choose(measurements(axes, given, failed))
