"""Stored runs: content-addressed folders, written atomically, readable without the simulator."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from runner.store.calibration import Calibration, find_calibration, open_calibration, write_calibration
    from runner.store.finished import Finished, find_outcome, find_run
    from runner.store.identity import run_hash, run_hashes
    from runner.store.kinds import prepare
    from runner.store.opening import open_stored
    from runner.store.run import Run, judge_run, open_run
    from runner.store.seal import DamagedError, SchemaError, simulated_part
    from runner.store.shards import RunOutcome
    from runner.store.sweep import Sweep, open_runs, open_sweep, write_grid, write_sweep

__all__ = [
    "Calibration",
    "DamagedError",
    "Finished",
    "Run",
    "RunOutcome",
    "SchemaError",
    "Sweep",
    "find_calibration",
    "find_outcome",
    "find_run",
    "judge_run",
    "open_calibration",
    "open_run",
    "open_runs",
    "open_stored",
    "open_sweep",
    "prepare",
    "run_hash",
    "run_hashes",
    "simulated_part",
    "write_calibration",
    "write_grid",
    "write_sweep",
]
_MODULES = {
    "calibration": "Calibration find_calibration open_calibration write_calibration",
    "finished": "Finished find_outcome find_run",
    "kinds": "prepare",
    "opening": "open_stored",
    "identity": "run_hash run_hashes",
    "run": "Run judge_run open_run",
    "seal": "DamagedError SchemaError simulated_part",
    "shards": "RunOutcome",
    "sweep": "Sweep open_runs open_sweep write_grid write_sweep",
}


def __getattr__(name: str) -> Any:
    """Import a name at its first use, so that `latest` needs neither NumPy nor pydantic."""
    for module, names in _MODULES.items():
        if name in names.split():
            globals()[name] = value = getattr(import_module(f"runner.store.{module}"), name)
            return value
    raise AttributeError(f"module 'runner.store' has no attribute '{name}'")
