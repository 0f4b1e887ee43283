from collections.abc import Callable
from pathlib import Path

import pytest
from support.short_runs import DAMPING, FREQUENCY, SHORT

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
