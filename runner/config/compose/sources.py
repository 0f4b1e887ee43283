"""Config source of Hydra that reads the files of config folders as data: no code, no other folders, bounded size.

Hydra would instantiate the objects that some of its keys name, and import the modules on its search path. A file of the
user must therefore not set Hydra's own keys, whatever package it has.

The options of controllers that are one function have a source of their own; their keys need no YAML file.
"""

import contextlib
import os
import pickle
import re
from collections.abc import Iterator, Mapping, Sequence
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path
from typing import Any

import hydra
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.object_type import ObjectType
from hydra.core.plugins import Plugins
from hydra.plugins.config_source import ConfigResult, ConfigSource
from hydra.plugins.search_path_plugin import SearchPathPlugin
from omegaconf import DictConfig, OmegaConf

from runner.base.bounded_yaml import CONFIG, YamlError, check_yaml
from runner.base.dotted_keys import dotted, leaves
from runner.base.errors import ConfigError
from runner.base.limits import ExcessError, read_text
from runner.base.paths import check_inside, conf_dir, ships
from runner.config.compose.files import outside_error, place_in, refuse_settings, settings_error
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


VERSION_BASE: Mapping[str, Any] = {"version_base": "1.3"} if hydra.__version__.startswith("1.3.") else {}
"""Argument of Hydra's functions for the present defaults; from Hydra 1.4 on they have these without the argument."""
_SCHEME = "checked"
_USERS = "command-line"  # Hydra's name of where such a folder comes from
_HEAD = 512  # characters that Hydra searches for the package of a file
_ENDS = re.compile(r"_global_.?|[./:@]")  # of the parts of a package; a package after `_global_` is absolute
_folders: ContextVar[Sequence[Path] | None] = ContextVar("folders", default=None)


@contextlib.contextmanager
def checked_sources(config_dirs: Sequence[Path]) -> Iterator[None]:
    """Let Hydra find and read config files only with CheckedSource, in conf/ and in folders of the user.

    In the folder of a study, names of experiments begin with the name of the study; see place_in.
    """
    for plugin in (CheckedSource, CheckedSearchPath, FunctionSource):
        Plugins.instance().register(plugin)
    before = _folders.set(config_dirs)
    try:
        yield
    finally:
        _folders.reset(before)


class CheckedSearchPath(SearchPathPlugin):
    """The search path of Hydra within `checked_sources`."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:
        """Read the primary folder and those of the user with CheckedSource, which Hydra also searches first."""
        folders = _folders.get()
        if folders is None:  # another program that uses Hydra
            return
        for element in search_path.get_path():
            if element.provider == "main":
                element.path = f"{_SCHEME}://{element.path}"
        for folder in reversed(folders):
            search_path.prepend(_USERS, f"{_SCHEME}://{folder}")
        search_path.prepend("runner", f"{_SCHEME}://{os.devnull}")  # has no file, and is first without other folders
        search_path.append("functions", f"{FunctionSource.scheme()}://")


class CheckedSource(ConfigSource):
    """A config folder; see Hydra's ConfigSource for the methods."""

    @staticmethod
    def scheme() -> str:
        """Return the URL scheme of paths of this source."""
        return _SCHEME

    def available(self) -> bool:
        """Return True if the folder exists."""
        return self.is_group("")

    def is_group(self, config_path: str) -> bool:
        """Return True if the folder has a group."""
        return self._place(config_path).is_dir()

    def is_config(self, config_path: str) -> bool:
        """Return True if the folder has a config.

        Raises:
            ConfigError: for a name that leads out of the folder. Hydra asks every source, and its own would read it.
        """
        if config_path.startswith("/") or ".." in config_path.split("/"):
            raise outside_error(config_path)
        return self._file(config_path).is_file() and not self._is_hidden(config_path)

    def _is_hidden(self, config_path: str) -> bool:
        """Return True for an ignored file in a user's folder: a config of Hydra, or a second root file."""
        return self.provider == _USERS and (
            config_path.startswith("hydra/") or ("/" not in config_path and self._has_ours(config_path))
        )

    def _has_ours(self, config_path: str) -> bool:
        return (conf_dir() / self._normalize_file_name(config_path)).is_file()

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:
        """Return the configs or groups in a group, sorted."""
        found: list[str] = []
        for entry in self._place(config_path).iterdir():
            self._list_add_result(found, f"{config_path}/{entry.name}".lstrip("/"), entry.name, results_filter)
        return sorted(set(found))

    def load_config(self, config_path: str) -> ConfigResult:
        """Return the content of a config.

        Raises:
            ConfigError: for a file that sets a forbidden key, is not YAML, is too large or is outside the folder.
        """
        path = self._file(config_path)
        check_inside(path, [Path(self.path)])
        status = path.stat()
        content, package = pickle.loads(_read(path, status.st_mtime_ns, status.st_size))  # noqa: S301 - made by _read
        if not ships(path):
            if self.provider == _USERS and self._has_ours(config_path):  # ambiguous name
                group, _, option = config_path.rpartition("/")
                raise ConfigError(
                    f"{group}: '{option}' is a built-in option, and {path} has the same name; rename that file"
                )
            _check_settings(content, config_path, package, path)
        return ConfigResult(self.provider, self.full_path(), content, {"package": package})

    def _place(self, config_path: str) -> Path:
        return place_in(Path(self.path), config_path)

    def _file(self, config_path: str) -> Path:
        return self._place(self._normalize_file_name(config_path))


@lru_cache(maxsize=512)
def _read(path: Path, *_: int) -> bytes:
    """Return the pickled content and package of a config file; its time of change and size are keys of the cache."""
    try:
        text = read_text(path, CONFIG.size)
        if not ships(path):
            check_yaml(text, path)
        with path.open(encoding="utf-8") as file:
            content = OmegaConf.load(file)
        return pickle.dumps((content, ConfigSource._get_header_dict(text[:_HEAD])["package"]))
    except YamlError as error:
        raise ConfigError(str(error)) from None
    except ExcessError as error:
        raise ConfigError(f"{path}: {error}") from None
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not a text file: {error}") from None
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or 'holds no mapping of keys'}") from None


def _check_settings(content: Any, config_path: str, package: str | None, path: Path) -> None:
    """Check that a file of the user, in its package, does not control how or where runs are simulated."""
    groups = list(_groups(content))
    refuse_settings(groups, path)
    group = config_path.rpartition("/")[0]
    leading = [text for text in groups if _is_leading(text.partition("@")[2])]
    if leading or _is_leading(group):
        raise settings_error(leading[0] if leading else config_path, path)
    place = (group if package is None else package).replace("/", ".")
    place = place[place.rfind("_global_") + len("_global_.") :] if "_global_" in place else place
    plain = OmegaConf.to_container(content, resolve=False)
    keys = (f"{place}.{dotted(key)}".lstrip(".") for key, value in leaves(plain, lists=False) if value != {})
    refuse_settings((key for key in keys if key.partition(".")[0] in ("hydra", "outputs")), path)


def _is_leading(package: str) -> bool:
    """Return True if a package may be that of Hydra or of the outputs folder after Hydra has resolved it."""
    return "$" in package or not {"hydra", "outputs"}.isdisjoint(_ENDS.split(package))


def _groups(config: Any) -> Iterator[str]:
    """Yield the groups and files that the defaults list of a config file names."""
    for entry in (config.get("defaults") if isinstance(config, DictConfig) else None) or ():
        yield from (str(text).split()[-1].lstrip("/") for text in (entry if isinstance(entry, Mapping) else [entry]))
