"""Loader of the configs of a plan."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from hydra import initialize_config_dir
from hydra.core.config_loader import ConfigLoader
from hydra.core.global_hydra import GlobalHydra
from hydra.types import RunMode
from omegaconf import DictConfig

from runner.base.paths import conf_dir
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.hydra_config import hydra_config
from runner.config.compose.no_code import code_refused


class ConfigSource(Protocol):
    """Where the configs of a plan come from.

    Attributes:
        hydra: Hydra's own loader.
        config_dirs: Config folders of the user's, whole paths.
    """

    hydra: ConfigLoader
    config_dirs: tuple[Path, ...]

    def load(self, options: Sequence[str], root: str = "config") -> DictConfig:
        """Return the config that is composed from a root and overrides of options; it must not be changed."""
        ...


class Loader:
    """Composes configs from options of groups.

    Args:
        config_dirs: Config folders of the user's, searched before ours.

    Attributes:
        hydra: Hydra's own loader.
        config_dirs: As given, whole paths.
    """

    def __init__(self, config_dirs: Sequence[Path] = ()) -> None:
        self.config_dirs = tuple(folder.resolve() for folder in config_dirs)
        with code_refused(), initialize_config_dir(str(conf_dir()), version_base="1.3", job_name="runner"):
            self.hydra: ConfigLoader = GlobalHydra.instance().config_loader()

    def load(self, options: Sequence[str], root: str = "config") -> DictConfig:
        """Return a composed config.

        Args:
            options: Overrides, as Hydra takes them.
            root: Name of the file in conf/ that the groups hang on.
        """
        return hydra_config(options, self.config_dirs, root)

    def sweeper(self, overrides: Sequence[str]) -> DictConfig:
        """Return the config of the sweeper, as `runner -m OVERRIDES` takes it; what is swept is left aside for that.

        Raises:
            ConfigError: for an option or key that does not exist.
        """
        try:
            config: DictConfig = hydra_config(overrides, self.config_dirs, mode=RunMode.MULTIRUN).hydra.sweeper
        except COMPOSITION_ERRORS as error:
            raise explain(error, self.config_dirs) from None
        return config
