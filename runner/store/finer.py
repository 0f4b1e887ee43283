"""Metrics of stored runs on a finer step of their plant: `outputs/finer/<hash>.json`, one file for each run."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.store.atomic import write_atomically
from runner.store.seal import read_json, sealed_json

FOLDER = "finer"
_REMEDY = "delete it: `runner compare` works it out again"


def write_finer(outputs: Path, name: str, reason: str, metrics: Mapping[str, FloatArray]) -> None:
    """Store what a run measures on a finer step.

    Args:
        outputs: The outputs folder.
        name: Hash of the run.
        reason: Why the plant cannot be compared with a finer step; empty where it can.
        metrics: Each metric in the first repetitions; what is not finite is beyond every number.

    Raises:
        StoreError: if the disk does not take it.
    """
    values = {key: [float(one) if np.isfinite(one) else None for one in row] for key, row in metrics.items()}
    write_atomically(outputs / FOLDER / f"{name}.json", sealed_json({"reason": reason, "metrics": values}))


def finer_names(outputs: Path) -> set[str]:
    """Return the hashes of the runs of which a finer step is stored, or that there is none."""
    return {path.stem for path in (outputs / FOLDER).glob("[!.]*.json")}


def read_finer(outputs: Path, name: str) -> Mapping[str, Sequence[float]]:
    """Return each metric of a run in its first repetitions on a finer step; nothing where it cannot have one.

    Raises:
        DamagedError: if it is not as it was written.
    """
    record = read_json(outputs / FOLDER / f"{name}.json", _REMEDY)
    return {key: [np.inf if one is None else one for one in row] for key, row in record["metrics"].items()}
