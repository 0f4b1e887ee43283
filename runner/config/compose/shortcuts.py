"""Shortcuts in Hydra 1.3 and OmegaConf 2.3, for half the CPU time of a composition and the same result."""

import pickle
from functools import cache, lru_cache
from typing import Any

import hydra
import omegaconf
from hydra._internal import defaults_list
from hydra._internal.config_repository import ConfigRepository
from hydra.core.config_search_path import ConfigSearchPath
from hydra.plugins.config_source import ConfigResult
from omegaconf import DictConfig, base, grammar_parser

_TEXTS = 4096  # distinct interpolations whose parse trees are kept


@cache
def take_shortcuts() -> None:
    """Let this process parse each interpolation once, and map known choices only for names that refer to them.

    OmegaConf parses an interpolation each time that it is resolved. Hydra converts all choices to a config for each
    file of a defaults list, although only names with an interpolation read it. Other versions remain as they are.
    """
    if omegaconf.__version__.startswith("2.3."):
        parse = lru_cache(maxsize=_TEXTS)(grammar_parser.parse)
        base.parse = grammar_parser.parse = parse  # type: ignore[attr-defined] # imported there
    if hydra.__version__.startswith("1.3."):
        create: Any = defaults_list._create_interpolation_map

        def create_if_read(overrides: Any, defaults: list[Any], self_added: bool) -> DictConfig | None:
            read = any(each.is_interpolation() for each in defaults if not each.is_self())
            return create(overrides, defaults, self_added) if read else None

        defaults_list._create_interpolation_map = create_if_read  # type: ignore[assignment] # None is not read


class KeptRepository(ConfigRepository):
    """Hydra's repository of config files, which reads each file once for several compositions.

    Args:
        config_search_path: The folders.
        kept: Pickled content by the path of a config, of the same files in the same folders; the class adds to it.
    """

    def __init__(self, config_search_path: ConfigSearchPath, kept: dict[str, bytes]) -> None:
        super().__init__(config_search_path)
        self._kept = kept

    def __deepcopy__(self, _: object) -> "KeptRepository":
        """Return the same object, because each composition has its own."""
        return self

    def initialize_sources(self, config_search_path: ConfigSearchPath) -> None:
        """Take other folders, of which nothing is kept."""
        self._kept = {}
        super().initialize_sources(config_search_path)

    def load_config(self, config_path: str) -> ConfigResult | None:
        """Return the content of a config; see Hydra's ConfigRepository."""
        if config_path not in self._kept:
            self._kept[config_path] = pickle.dumps(super().load_config(config_path))
        result: ConfigResult | None = pickle.loads(self._kept[config_path])  # noqa: S301 - made here
        return result


@lru_cache(maxsize=4)
def kept_files(*_: object) -> dict[str, bytes]:
    """Return the kept content of config files by path; the arguments are the state of the files."""
    return {}
