"""Plans of sweeps from overrides."""

from collections.abc import Sequence
from pathlib import Path

from runner.config.compose.composer import Composer
from runner.store.axes import SweepAxis
from runner.sweeps.plan import Grid


def plan_sweep(overrides: Sequence[str | SweepAxis], config_dirs: Sequence[Path] = ()) -> Grid:
    """Return the plan of `runner -m OVERRIDES`; see Grid."""
    return Grid(overrides, Composer(config_dirs))
