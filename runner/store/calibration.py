"""Stored calibrations: `outputs/calibrations/<hash>/` with config.yaml, robot.urdf and result.json."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import yaml
from numpy.typing import NDArray

from runner.store.seal import MEND, DamagedError, Stored, check_job, read_job, write_job

_RECORD = "result.json"
_NEEDED = ("estimates", "truth", "errors", "deviations", "measures", "consistency", "postures", "provenance")
Table = Literal["estimates", "errors", "deviations", "measures"]


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Stored):
    """A stored calibration; its record is the content of result.json."""

    def __repr__(self) -> str:
        return f"Calibration of {', '.join(self.record['estimates'])}\n  {self.folder}"

    @property
    def status(self) -> str:
        """Always "ok": one that fails is not stored."""
        return "ok"

    @property
    def truth(self) -> Mapping[str, float]:
        """True value of each estimate."""
        truth: Mapping[str, float] = self.record["truth"]
        return truth

    @property
    def consistency(self) -> Mapping[str, Any] | None:
        """Mean normalised error squared, its 99 % band and whether it is in it; None if a quantity has no error."""
        consistency: Mapping[str, Any] | None = self.record["consistency"]
        return consistency

    @property
    def postures(self) -> NDArray[np.float64]:
        """True joint positions at which the arm was measured, shape (N, nq), in rad."""
        return np.array(self.record["postures"])

    def summary(self, table: Table, name: str) -> Mapping[str, Any]:
        """Return unit, values of each repetition, median, min and max of a name in a table."""
        summary: Mapping[str, Any] = self.record[table][name]
        return summary

    def values(self, table: Table, *names: str) -> NDArray[np.float64]:
        """Return the values of names in a table, of all if none is given, shape (repetitions, number of names)."""
        columns = [self.record[table][name]["values"] for name in names or self.record[table]]
        return np.array(columns, dtype=float).T


def find_calibration(outputs: Path, name: str) -> Calibration | None:
    """Return the finished calibration with a hash, or None if there is none.

    Raises:
        DamagedError: if the calibration is damaged.
    """
    folder = outputs / "calibrations" / name
    if not (folder / _RECORD).exists():
        return None
    check_job(folder, _RECORD)
    return open_calibration(folder)


def open_calibration(folder: Path) -> Calibration:
    """Open a stored calibration.

    Raises:
        DamagedError: if the folder is not a calibration, or is damaged.
    """
    record, config = read_job(folder, _RECORD)
    missing = [key for key in _NEEDED if key not in record]
    if missing:
        raise DamagedError(
            f"cannot read {folder / _RECORD}: it is not a calibration's result: {', '.join(missing)} missing; {MEND}"
        )
    return Calibration(folder, config, record)


def write_calibration(
    outputs: Path, name: str, config: Mapping[str, Any], urdf: str, record: Mapping[str, Any]
) -> Calibration:
    """Store a calibration, its result last.

    Raises:
        StoreError: if it cannot be written.
    """
    folder = outputs / "calibrations" / name
    text = yaml.safe_dump(dict(config), sort_keys=False)
    write_job(folder, _RECORD, record, {"config.yaml": text.encode(), "robot.urdf": urdf.encode()})
    return open_calibration(folder)
