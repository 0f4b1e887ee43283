"""Metrics of stored runs with a finer plant step: `outputs/finer/<hash>.json`, one file for each run."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.store.atomic import write_atomically
from runner.store.seal import read_json, sealed_json

FOLDER = "finer"
_REMEDY = "delete it: `runner compare` computes it again"


def write_finer(outputs: Path, name: str, reason: str, metrics: Mapping[str, FloatArray]) -> None:
    """Store the metrics of a run with a finer step.

    Args:
        outputs: The outputs folder.
        name: Hash of the run.
        reason: Reason why the plant cannot use a finer step; empty if it can.
        metrics: Each metric in the first repetitions; a value that is not finite is read back as infinity.

    Raises:
        StoreError: if it cannot be written.
    """
    values = {key: [float(one) if np.isfinite(one) else None for one in row] for key, row in metrics.items()}
    write_atomically(outputs / FOLDER / f"{name}.json", sealed_json({"reason": reason, "metrics": values}))


def finer_names(outputs: Path) -> set[str]:
    """Return the hashes of the runs that have a stored result for a finer step, or a reason why they have none."""
    return {path.stem for path in (outputs / FOLDER).glob("[!.]*.json")}


def read_finer(outputs: Path, name: str) -> Mapping[str, Sequence[float]]:
    """Return each metric of a run with a finer step, in its first repetitions; empty if the run cannot have one.

    Raises:
        DamagedError: if the file differs from what was written.
    """
    record = read_json(outputs / FOLDER / f"{name}.json", _REMEDY)
    return {key: [np.inf if one is None else one for one in row] for key, row in record["metrics"].items()}
