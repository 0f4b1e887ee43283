"""Hydra's loader, kept for many configs."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Protocol

from hydra import initialize_config_dir
from hydra.core.config_loader import ConfigLoader
from hydra.core.global_hydra import GlobalHydra
from hydra.types import RunMode
from omegaconf import DictConfig

from runner.config.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.no_code import code_refused
from runner.paths import conf_dir


class ConfigSource(Protocol):
    """Where the configs of a plan come from.

    Attributes:
        hydra: Hydra's own loader.
        config_dirs: Config folders of the user's, whole paths.
    """

    hydra: ConfigLoader
    config_dirs: tuple[Path, ...]

    def load(self, options: Sequence[str]) -> DictConfig:
        """Return the config of a run that is composed from overrides of options; it must not be changed."""
        ...


class Loader:
    """Composes configs from options of groups; each combination once, as that takes some 40 ms.

    Args:
        config_dirs: Config folders of the user's, searched before ours.

    Attributes:
        hydra: Hydra's own loader.
        config_dirs: As given, whole paths.
    """

    def __init__(self, config_dirs: Sequence[Path] = ()) -> None:
        self.config_dirs = tuple(folder.resolve() for folder in config_dirs)
        search = f"hydra.searchpath=[{','.join(f'file://{folder}' for folder in self.config_dirs)}]"
        self._search = (search,) if self.config_dirs else ()
        with code_refused(), initialize_config_dir(str(conf_dir()), version_base="1.3", job_name="runner"):
            self.hydra: ConfigLoader = GlobalHydra.instance().config_loader()
        self._load = cache(self._compose)

    def load(self, options: Sequence[str], root: str = "config") -> DictConfig:
        """Return a composed config, which must not be changed.

        Args:
            options: Overrides, as Hydra takes them.
            root: Name of the file in conf/ that the groups hang on.
        """
        return self._load(root, tuple(options))

    def sweeper(self, overrides: Sequence[str]) -> DictConfig:
        """Return the config of the sweeper, as `runner -m OVERRIDES` takes it; what is swept is left aside for that.

        Raises:
            ConfigError: for an option or key that does not exist.
        """
        try:
            config: DictConfig = self._compose("config", tuple(overrides), RunMode.MULTIRUN).hydra.sweeper
        except COMPOSITION_ERRORS as error:
            raise explain(error, self.config_dirs) from None
        return config

    def _compose(self, root: str, options: tuple[str, ...], mode: RunMode = RunMode.RUN) -> DictConfig:
        with code_refused():
            return self.hydra.load_configuration(root, [*self._search, *options], mode)
