"""Config-driven batch experiments for robot-arm control, with reports.

    >>> import runner
    >>> run = runner.run("noise=thesis", robot="macro", duration=0.1)
    >>> run.status
    'ok'

`run`, `sweep`, `tune` and `calibrate` do what the commands do, `report` writes a report, `compare` compares runs or
sweeps, `challenge` asks for which choices an answer holds, `identify` fits an arm to logs; `open_run`, `open_sweep`,
`open_tuning`, `open_challenge` and `open_identification` open what is stored. docs/python.md shows them at work.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from runner.api.challenge import Challenge, challenge
    from runner.api.commands import calibrate, run, sweep, tune
    from runner.api.identification import Identification, identify
    from runner.api.results import (
        Report,
        compare,
        open_challenge,
        open_identification,
        open_run,
        open_sweep,
        open_tuning,
        report,
    )
    from runner.api.run import Run
    from runner.api.sweep import Sweep
    from runner.api.tuning import Tuning
    from runner.base.errors import RunnerError
    from runner.store import Calibration
    from runner.store.record import Metric

__all__ = [
    "Calibration",
    "Challenge",
    "Identification",
    "Metric",
    "Report",
    "Run",
    "RunnerError",
    "Sweep",
    "Tuning",
    "calibrate",
    "challenge",
    "compare",
    "identify",
    "open_challenge",
    "open_identification",
    "open_run",
    "open_sweep",
    "open_tuning",
    "report",
    "run",
    "sweep",
    "tune",
]
_PLACES = {
    "Calibration": "runner.store",
    "Challenge": "runner.api.challenge",
    "Identification": "runner.api.identification",
    "Metric": "runner.store.record",
    "Report": "runner.api.results",
    "Run": "runner.api.run",
    "RunnerError": "runner.base.errors",
    "Sweep": "runner.api.sweep",
    "Tuning": "runner.api.tuning",
    "calibrate": "runner.api.commands",
    "challenge": "runner.api.challenge",
    "compare": "runner.api.results",
    "identify": "runner.api.identification",
    "open_challenge": "runner.api.results",
    "open_identification": "runner.api.results",
    "open_run": "runner.api.results",
    "open_sweep": "runner.api.results",
    "open_tuning": "runner.api.results",
    "report": "runner.api.results",
    "run": "runner.api.commands",
    "sweep": "runner.api.commands",
    "tune": "runner.api.commands",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for only when it is asked for, so that `runner --help` answers at once."""
    if name not in _PLACES:
        raise AttributeError(f"module 'runner' has no attribute '{name}'")
    return getattr(import_module(_PLACES[name]), name)


def __dir__() -> list[str]:
    """Name what is for users, and no modules."""
    return list(__all__)
