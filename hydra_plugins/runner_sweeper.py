"""Sweeper plug-in of Hydra; Hydra finds it by the name of this folder."""

from typing import Any

from hydra.plugins.sweeper import Sweeper
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig


class RunnerSweeper(Sweeper):
    """Passes the config of a sweep to the task of `runner`, which simulates its runs.

    Args:
        workers: Number of processes on this machine; 0 for the current process.
        address: Address of a running Dask scheduler, or None.
        params: Values by key, as on the command line.
    """

    def __init__(self, workers: int, address: str | None, params: Any) -> None:
        """Take the keys of conf/hydra/sweeper/runner.yaml, which the task reads from the config."""

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Take the task and the config; see Hydra's Sweeper."""
        self._task: Any = task_function
        self._config = config

    def sweep(self, arguments: list[str]) -> None:
        """Pass on the sweep; see Hydra's Sweeper."""
        self._task.sweep(self._config)
