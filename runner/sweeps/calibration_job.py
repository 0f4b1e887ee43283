"""Calibration job: check of a composed config, repeated calibration, and storage or reuse of the result."""

import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from runner import store
from runner.base import progress
from runner.base.arrays import FloatArray
from runner.base.ticks import add_ticks, counter
from runner.calibration import consistency
from runner.calibration.procedures import Outcome
from runner.config.calibration import CalibrationConfig, validate_calibration
from runner.config.compose.compose import Composed, compose
from runner.simulation import provenance
from runner.store.kinds import note

CALIBRATION = "calibrate"
"""Root of a calibration's config; the root of a run's config is "config"."""
LEVEL = 0.99
"""Probability of the band in which the mean normalised error squared must lie."""
TICKS = 200
"""Ticks of a run that take as long as one repetition of a calibration."""


def calibrate(*overrides: str, config_dirs: Sequence[Path] = ()) -> store.Calibration:
    """Run `runner calibrate OVERRIDES` from Python.

    Args:
        overrides: Hydra overrides, such as "calibration=gravity" and "calibration.orientations=8".
        config_dirs: User config folders, searched before the built-in ones.

    Returns:
        The stored calibration; an existing one is reused.

    Raises:
        ConfigError: if the calibration cannot be carried out; the error lists all problems of the config.
        StoreError: if the outputs folder cannot be written.
    """
    composed = compose(overrides, config_dirs, root=CALIBRATION)
    config = validate_calibration(composed)
    outputs = Path(config.settings.outputs)
    name = store.run_hash(config.resolved, config.arm.urdf)
    try:
        stored = store.find_calibration(outputs, name)
    except store.DamagedError as error:
        print(f"runner: {error}; making it again", file=sys.stderr)
        stored = None
    if stored is None:
        progress.begin("calibrating", total=TICKS * config.settings.repetitions, unit="ticks", count=counter())
        stored = store.write_calibration(outputs, name, config.resolved, config.arm.urdf, carry_out(config, composed))
    note(stored.folder)
    return stored


def carry_out(config: CalibrationConfig, composed: Composed) -> dict[str, Any]:
    """Repeat a calibration; return the record to store.

    Args:
        config: The checked config.
        composed: The composed config before its check, for provenance.
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
        "provenance": _provenance(config, composed, outcomes),
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


def _provenance(config: CalibrationConfig, composed: Composed, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    messages = next((outcome.messages for outcome in outcomes if outcome.messages), ())
    return {
        **provenance.describe_origin(composed, "calibrate"),
        "choices": {group: choice for group, choice in composed.choices.items() if group in config.resolved},
        "flange": config.arm.flange,
        "joints": list(config.arm.model.joint_names),
        "seed": config.settings.seed,
        "warnings": [*config.robot.warnings, *messages],
    }
