from collections.abc import Callable
from pathlib import Path

import pytest
from short_runs import DAMPING, FREQUENCY, SHORT

from runner.tuning.objective import Objective
from runner.tuning.run import tune
from runner.tuning.study import Tuning


@pytest.fixture
def tuned(tmp_path: Path) -> Callable[..., Tuning]:
    """Tune a short Macro run in this process, or as `hydra.sweeper.workers` says."""

    def make(*overrides: str, trials: int = 8, at_once: int = 3, objectives=(("peak_torque", "minimize"),)) -> Tuning:
        given = overrides or (FREQUENCY, DAMPING)
        return tune(
            [*SHORT, f"outputs={tmp_path}/outputs", "hydra.sweeper.workers=0", *given],
            [Objective(*objective) for objective in objectives],
            trials,
            at_once,
            "runner tune ...",
        )

    return make


@pytest.fixture
def simulated_runs(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the runs that are simulated."""
    from runner.sweep import work

    names: list[str] = []
    make = work._make

    def note(name, *others):
        names.append(name)
        return make(name, *others)

    monkeypatch.setattr(work, "_make", note)
    return names
