"""Opening of a stored result of any kind."""

from pathlib import Path

from runner.store.calibration import Calibration, open_calibration
from runner.store.kinds import kind_of
from runner.store.run import Run, open_run
from runner.store.sweep import Sweep, open_sweep


def open_stored(folder: Path) -> Run | Sweep | Calibration:
    """Open a folder; a tuning is opened as the sweep of its trials, a challenge as that of its runs.

    Raises:
        StoreError: if the folder is none of these, or its run is unfinished.
        DamagedError: if the result is damaged.
    """
    kind = kind_of(folder)
    if kind in ("sweep", "tuning", "challenge"):
        return open_sweep(folder)
    return open_calibration(folder) if kind == "calibration" else open_run(folder)
