"""Repetitions of a calibration, and their record."""

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.ticks import add_ticks
from runner.calibration.procedure import Outcome
from runner.calibration.uncertainty import consistency
from runner.simulation import provenance
from runner.simulation.calibration_config import CalibrationConfig

LEVEL = 0.99
"""Probability of the band in which the mean normalised error squared must lie."""
TICKS = 200
"""Ticks of a run that take about as long as one repetition of a calibration."""


def simulate_calibration(config: CalibrationConfig) -> dict[str, Any]:
    """Repeat a calibration; return the record to store.

    Args:
        config: The checked config.
    """
    wall = time.perf_counter()
    procedure, settings = config.procedure, config.settings
    outcomes = []
    for repetition in range(settings.repetitions):
        outcomes.append(procedure.repeat(np.random.default_rng([settings.seed, repetition])))
        add_ticks(TICKS)
    deviations = [np.sqrt(np.diagonal(outcome.covariance)) for outcome in outcomes]
    return {
        "repetitions": settings.repetitions,
        "truth": dict(zip(procedure.estimates, procedure.truth.tolist(), strict=True)),
        "estimates": _table(procedure.estimates, (outcome.estimates for outcome in outcomes)),
        "errors": _table(procedure.errors, (outcome.errors for outcome in outcomes)),
        "deviations": _table(procedure.errors, deviations),
        "measures": _table(procedure.measures, ([o.measures[name] for name in procedure.measures] for o in outcomes)),
        "consistency": judge(outcomes),
        "postures": procedure.postures.tolist(),
        "timing": {"wall_s": time.perf_counter() - wall},
        "provenance": _provenance(config, outcomes),
    }


def _table(units: Mapping[str, str], rows: Iterable[FloatArray | Sequence[float]]) -> dict[str, dict[str, Any]]:
    """Return a summary of each column by name."""
    columns = np.array(list(rows)).T
    return {
        name: {
            "unit": unit,
            "values": column.tolist(),
            "median": float(np.median(column)),
            "min": float(column.min()),
            "max": float(column.max()),
        }
        for (name, unit), column in zip(units.items(), columns, strict=True)
    }


def judge(outcomes: Sequence[Outcome]) -> dict[str, Any] | None:
    """Return the consistency of the errors with their covariances; None if a variance is zero."""
    covariances = np.array([outcome.covariance for outcome in outcomes])
    if not (np.diagonal(covariances, axis1=1, axis2=2) > 0.0).all():
        return None
    errors = np.array([outcome.errors for outcome in outcomes])
    judged = consistency(errors, covariances, LEVEL)
    single = [consistency(errors[[k]], covariances[[k]], LEVEL).mean for k in range(len(outcomes))]
    return {**asdict(judged), "level": LEVEL, "holds": judged.holds, "values": single}


def _provenance(config: CalibrationConfig, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    composed = config.composed
    messages = next((outcome.messages for outcome in outcomes if outcome.messages), ())
    return {
        **provenance.describe_origin(composed, "calibrate"),
        "choices": {group: choice for group, choice in composed.choices.items() if group in config.resolved},
        "flange": config.arm.flange,
        "joints": list(config.arm.model.joint_names),
        "seed": config.settings.seed,
        "warnings": [*config.robot.warnings, *messages],
    }
