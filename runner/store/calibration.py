"""Calibrations as they are stored: `outputs/calibrations/<hash>/` with config.yaml, robot.urdf and result.json."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import yaml
from numpy.typing import NDArray

from runner.errors import StoreError
from runner.store.atomic import write_atomically
from runner.store.stored import Stored, read_job

SCHEMA = 1
_NEEDED = ("estimates", "truth", "errors", "deviations", "measures", "consistency", "postures", "provenance")
Table = Literal["estimates", "errors", "deviations", "measures"]


@dataclass(frozen=True)
class Calibration(Stored):
    """A stored calibration; its record is the content of result.json."""

    @property
    def truth(self) -> Mapping[str, float]:
        """True value of each estimate."""
        truth: Mapping[str, float] = self.record["truth"]
        return truth

    @property
    def consistency(self) -> Mapping[str, Any] | None:
        """Mean normalised error squared, its 99 % band and whether it holds; None where something has no error."""
        consistency: Mapping[str, Any] | None = self.record["consistency"]
        return consistency

    @property
    def postures(self) -> NDArray[np.float64]:
        """True joint positions in which the arm was read, shape (N, nq), in rad."""
        return np.array(self.record["postures"])

    def summary(self, table: Table, name: str) -> Mapping[str, Any]:
        """Return unit, values of each repetition, median, min and max of a name in a table."""
        summary: Mapping[str, Any] = self.record[table][name]
        return summary

    def values(self, table: Table, *names: str) -> NDArray[np.float64]:
        """Return the values of names in a table, all where none is given, shape (repetitions, number of names)."""
        columns = [self.record[table][name]["values"] for name in names or self.record[table]]
        return np.array(columns, dtype=float).T


def find_calibration(outputs: Path, name: str) -> Calibration | None:
    """Return the calibration of that hash, or None when it is missing, unfinished or damaged."""
    try:
        calibration = open_calibration(outputs / "calibrations" / name)
        return calibration if calibration.urdf else None
    except StoreError:
        return None


def open_calibration(folder: Path) -> Calibration:
    """Open a stored calibration.

    Raises:
        StoreError: if the folder is none, or damaged.
    """
    record, config = read_job(folder, "result.json", "calibration")
    if not isinstance(record, dict) or record.get("schema") != SCHEMA or any(key not in record for key in _NEEDED):
        raise StoreError(
            f"{folder / 'result.json'} is no calibration's result: it needs schema {SCHEMA}, {', '.join(_NEEDED)}"
        )
    return Calibration(folder, config, record)


def write_calibration(
    outputs: Path, name: str, config: Mapping[str, Any], urdf: str, record: Mapping[str, Any]
) -> Calibration:
    """Store a calibration, its result last.

    Raises:
        StoreError: if the disk does not take it.
    """
    folder = outputs / "calibrations" / name
    write_atomically(folder / "config.yaml", yaml.safe_dump(dict(config), sort_keys=False).encode())
    write_atomically(folder / "robot.urdf", urdf.encode())
    content = json.dumps({"schema": SCHEMA, **record}, indent=1, allow_nan=False) + "\n"
    write_atomically(folder / "result.json", content.encode())
    return open_calibration(folder)
