from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from runner.sweeps.grid import plan_sweep
from runner.sweeps.run import Ended, Engine, run_sweep

SHORT = ("robot=macro", "duration=0.05")


@pytest.fixture
def sweep(tmp_path: Path) -> Callable[..., Ended]:
    """Make a sweep of short Macro runs in this process, or as `engine` says."""

    def make(
        *overrides: str,
        engine: Engine = Engine(0, None),  # noqa: B008 - it cannot be changed
        config_dirs: Sequence[Path] = (),
    ) -> Ended:
        plan = plan_sweep([*SHORT, f"outputs={tmp_path}/outputs", *overrides], config_dirs)
        return run_sweep(plan, engine, "runner -m ...")

    return make
