"""Composing the config of one trial after another: Hydra reads its files once."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from hydra import initialize_config_dir
from hydra.core.global_hydra import GlobalHydra
from hydra.types import RunMode
from omegaconf import DictConfig

from runner.config.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.no_code import code_refused
from runner.paths import conf_dir
from runner.sweeps.plan import Plan


class Composer:
    """Composes configs that differ in values.

    Args:
        config_dirs: Config folders of the user's.
    """

    def __init__(self, config_dirs: Sequence[Path]) -> None:
        search = [f"hydra.searchpath=[{','.join(f'file://{folder.resolve()}' for folder in config_dirs)}]"]
        self._search = search if config_dirs else []
        self._config_dirs = config_dirs
        with code_refused(), initialize_config_dir(str(conf_dir()), version_base="1.3", job_name="runner"):
            self._loader = GlobalHydra.instance().config_loader()
        self._compose = cache(self._load)

    def plan(self, overrides: Sequence[str]) -> Plan:
        """Return the plan of a sweep; see Plan."""
        return Plan(overrides, self._loader, lambda options: self._compose(tuple(options)), self._config_dirs)

    def sweeper(self, overrides: Sequence[str]) -> DictConfig:
        """Return the config of the sweeper, as `runner -m OVERRIDES` takes it.

        Raises:
            ConfigError: for an option or key that does not exist.
        """
        try:
            config: DictConfig = self._compose(tuple(overrides)).hydra.sweeper
        except COMPOSITION_ERRORS as error:
            raise explain(error, self._config_dirs) from None
        return config

    def _load(self, overrides: tuple[str, ...]) -> DictConfig:
        with code_refused():
            return self._loader.load_configuration("config", [*self._search, *overrides], RunMode.RUN)
