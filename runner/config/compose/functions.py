"""Config source of Hydra with an option for each controller that is one function; its keys need no YAML file."""

from hydra.core.object_type import ObjectType
from hydra.plugins.config_source import ConfigResult, ConfigSource
from omegaconf import OmegaConf

from runner.base.paths import conf_dir
from runner.controllers import CONTROLLERS


class FunctionSource(ConfigSource):
    """The options of functions in the group of controllers; see Hydra's ConfigSource for the methods."""

    @staticmethod
    def scheme() -> str:
        """Return the URL scheme of paths of this source."""
        return "functions"

    def available(self) -> bool:
        """Return True, also without functions."""
        return True

    def is_group(self, config_path: str) -> bool:
        """Return True for the group of controllers."""
        return config_path in ("", CONTROLLERS.group)

    def is_config(self, config_path: str) -> bool:
        """Return True if a config is the option of a function.

        Raises:
            ConfigError: if a function cannot be a controller.
        """
        return self._option(config_path) in CONTROLLERS.of_functions()

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:
        """Return the options of a group."""
        return sorted(CONTROLLERS.of_functions()) if config_path == CONTROLLERS.group else []

    def load_config(self, config_path: str) -> ConfigResult:
        """Return the keys of a function: those of conf/function_law.yaml, then its own with their defaults."""
        own = CONTROLLERS.of_functions()[self._option(config_path)]
        content = OmegaConf.merge(OmegaConf.load(conf_dir() / "function_law.yaml"), own.VALUES)
        return ConfigResult(self.provider, self.full_path(), content, {"package": None})

    def _option(self, config_path: str) -> str:
        group, _, name = config_path.partition("/")
        return name.removesuffix(".yaml") if group == CONTROLLERS.group else ""
