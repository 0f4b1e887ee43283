"""Config-driven batch experiments for robot-arm control, with reports."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from runner.calibration_job import calibrate
    from runner.execution import run
    from runner.store import Calibration, Run, Sweep, open_run, open_sweep

__all__ = ["Calibration", "Run", "Sweep", "calibrate", "open_run", "open_sweep", "run"]


def __getattr__(name: str) -> Any:
    """Import the simulator only when it is asked for, so that `runner --help` answers at once."""
    if name == "run":
        from runner.execution import run

        return run
    if name == "calibrate":
        from runner.calibration_job import calibrate

        return calibrate
    if name in ("Calibration", "Run", "Sweep", "open_run", "open_sweep"):
        from runner import store

        return getattr(store, name)
    raise AttributeError(f"module 'runner' has no attribute '{name}'")
