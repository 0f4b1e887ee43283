"""Hydra's door to our sweeps; Hydra finds it by the name of this folder."""

import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hydra.plugins.sweeper import Sweeper
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig


class RunnerSweeper(Sweeper):
    """Hands a sweep's command line to `runner.sweeps`, which composes, checks and makes its runs.

    Args:
        workers: Number of processes on this machine; 0 for the process itself.
        address: Address of a running Dask scheduler, or None.
        params: Values by key, as on the command line, which comes after and wins.
    """

    def __init__(self, workers: int, address: str | None, params: Mapping[str, Any] | None) -> None:
        self._sweeper = {"workers": workers, "address": address, "params": params}

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Take what Hydra knows; see its Sweeper."""
        task: Any = task_function
        self._loader, self._task, self._config = hydra_context.config_loader, task, config

    def sweep(self, arguments: list[str]) -> None:
        """Make the sweep; see Hydra's Sweeper."""
        self._task.sweep(lambda: self._make(arguments))

    def _make(self, arguments: list[str]) -> Any:
        from runner.sweeps.run import sweep_typed

        self.hydra = self._loader
        sources = self._config.hydra.runtime.config_sources
        self.config_dirs = tuple(Path(each.path).resolve() for each in sources if each.provider == "command-line")
        command = shlex.join(["runner", *(argument.removeprefix("++") for argument in sys.argv[1:])])
        return sweep_typed(arguments, self._sweeper, self, command)

    def load(self, options: Sequence[str], _root: str = "config") -> DictConfig:
        """Compose a config from overrides of options, as Hydra does for one job; see ConfigSource."""
        config: DictConfig = self._loader.load_sweep_config(self._config, list(options))
        return config
