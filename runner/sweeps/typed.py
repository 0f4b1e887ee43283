"""The sweep of a command line."""

import sys
from collections.abc import Mapping, Sequence
from typing import Any

from omegaconf import DictConfig

from runner.sweeps.grid import Grid
from runner.sweeps.loading import ConfigSource
from runner.sweeps.run import Ended, Engine, run_sweep


def sweep_typed(
    arguments: Sequence[str], sweeper: DictConfig | Mapping[str, Any], source: ConfigSource, command: str
) -> Ended:
    """Make the runs of a command line that are missing.

    Args:
        arguments: Overrides as `force` leaves them, Hydra's own left out.
        sweeper: Values of hydra.sweeper: workers, address, and params, the values by key that a file gives; those of
            the command line come after and win.
        source: Composes the configs.
        command: The command line, kept with the sweep.
    """
    params = [f"{key}={value}" for key, value in (sweeper["params"] or {}).items()]
    plan = Grid([*params, *arguments], source)
    if len(plan) == 1:
        text = "nothing is swept, and a single run is made: no key has several values, as seed=0,1 has"
        print(f"runner: {text}", file=sys.stderr)
    return run_sweep(plan, Engine(sweeper["workers"], sweeper["address"]), command)
