"""No config runs code, reads the environment or grows without end: a config folder may be a stranger's.

Hydra would make whatever some of its own keys name, and import the modules that its search path names.
"""

import contextlib
import pickle
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.config_repository import ConfigRepository
from hydra._internal.sources_registry import SourcesRegistry
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.plugins import Plugins
from hydra.plugins.config_source import ConfigResult, ConfigSource
from omegaconf import DictConfig, OmegaConf

from runner.config.bounded_yaml import CONFIG, YamlError, check_yaml
from runner.config.interpolation import check_references, refuse_functions
from runner.config.memory import Memory
from runner.config.work_folder import place_in
from runner.engines import default_plant
from runner.errors import ConfigError
from runner.paths import conf_dir
from runner.texts import quoted

_NO_LOGGING = {"version": 1, "root": None, "disable_existing_loggers": False}
_SWEEPER = {"_target_": "hydra_plugins.runner_sweeper.RunnerSweeper", "_recursive_": False}
_SWEEPER_KEYS = ("workers", "address", "params")
_READ = Memory(512)  # files as Hydra parses them, pickled
_NAMED_BY_CONFIGS = ("hydra.searchpath", "main", "command-line")  # others are Hydra's own and installed plug-ins'


@contextlib.contextmanager
def code_refused() -> Iterator[set[Path]]:
    """Let Hydra go on only with configs that name no code, whichever file, package or override they come from.

    Yields a set that takes the config files that are read.

    In a config folder that is a work's, experiments are found under its name; see work_folder. The one function that a
    file calls, conf/plant/default.yaml, is ours.
    """
    Plugins.instance()  # registers what reads files, as a class of Hydra's own making
    OmegaConf.register_new_resolver("default_plant", lambda: f"/plant/{default_plant()}", replace=True)
    files = SourcesRegistry.instance().resolve("file")
    load, search = ConfigLoaderImpl.load_configuration, ConfigRepository.initialize_sources
    load_file, is_config, is_group = files.load_config, files.is_config, files.is_group
    read: set[Path] = set()

    def checked_load(self: ConfigLoaderImpl, *args: Any, **options: Any) -> DictConfig:
        try:
            config = load(self, *args, **options)
        except (TypeError, KeyError, IndexError, AttributeError, AssertionError, RecursionError) as error:
            found = f"{type(error).__name__} {error}".strip()
            raise ConfigError([f"Hydra cannot compose the config: {found}; look at what is unusual in it"]) from error
        check_composed(config)
        return config

    def checked_search(self: ConfigRepository, config_search_path: ConfigSearchPath) -> None:
        refuse_modules(config_search_path)
        search(self, config_search_path)

    def load_sound(self: ConfigSource, path: Path, place: str) -> bytes:
        check_file(path)
        return pickle.dumps(load_file(self, place))

    def checked_read(self: ConfigSource, config_path: str) -> ConfigResult:
        place = place_in(Path(self.path), config_path)
        path = Path(self.path) / self._normalize_file_name(place)
        read.add(path.resolve())
        if not path.is_file():
            return load_file(self, place)  # raises
        status = path.stat()
        key = (self.provider, self.path, place, status.st_mtime_ns, status.st_size)
        result: ConfigResult = pickle.loads(_READ.known(key, lambda: load_sound(self, path, place)))  # noqa: S301
        return result

    with (
        _replaced(ConfigLoaderImpl, checked_load, "load_configuration"),
        _replaced(ConfigRepository, checked_search, "initialize_sources"),
        _replaced(files, checked_read, "load_config"),
        _replaced(
            files, lambda self, config_path: is_config(self, place_in(Path(self.path), config_path)), "is_config"
        ),
        _replaced(files, lambda self, config_path: is_group(self, place_in(Path(self.path), config_path)), "is_group"),
    ):
        yield read


@contextlib.contextmanager
def _replaced(owner: type, function: Callable[..., Any], name: str) -> Iterator[None]:
    before = getattr(owner, name)
    setattr(owner, name, function)
    try:
        yield
    finally:
        setattr(owner, name, before)


def check_composed(config: DictConfig) -> None:
    """Check a config that Hydra composed, before any reference in it is resolved.

    Raises:
        ConfigError: for a key that refers to itself or stands for too much, and for what names code; see refuse_code.
    """
    plain: Any = OmegaConf.to_container(config, resolve=False)
    check_references(plain)
    refuse_code(config)


def refuse_modules(search_path: ConfigSearchPath) -> None:
    """Check that configs are looked for in folders alone: Hydra imports a module to look into it.

    Raises:
        ConfigError: for anything else that a config or the command line names, and for a folder that does not exist.
    """
    named = [element for element in search_path.get_path() if str(element.provider).startswith(_NAMED_BY_CONFIGS)]
    for path in (str(element.path) for element in named):
        scheme, _, place = path.rpartition("://")
        if scheme in ("", "file") and Path(place).is_dir():
            continue
        found = "is no folder" if scheme in ("", "file") else "names a module"
        raise ConfigError(
            [
                f"hydra.searchpath: {quoted(path)} {found}; allowed: folders, as in "
                "hydra.searchpath=[file:///home/me/configs], or simpler --config-dir FOLDER"
            ]
        )


def check_file(path: Path) -> None:
    """Check a config file before Hydra reads it; ours need no check.

    Raises:
        ConfigError: if it is too large or nested too deeply, refers to itself, or calls a function of OmegaConf.
    """
    if conf_dir() in path.resolve().parents or not path.is_file():
        return
    with path.open(encoding="utf-8") as file:
        text = file.read(CONFIG.characters + 1)
    try:
        check_yaml(text, path)
    except YamlError as error:
        raise ConfigError([str(error)]) from None
    refuse_functions(text, str(path))


def refuse_code(config: DictConfig) -> None:
    """Check the keys of Hydra's own by which it runs code.

    These make objects (callbacks, sweeper), set what Python starts with (job.env_set), name classes (logging), or say
    where Hydra itself writes.

    Raises:
        ConfigError: for each that holds something else than ours.
    """
    bad = [key for key in ("callbacks", "job.env_set", "job.chdir", "output_subdir") if _select(config, key)]
    bad += [key for key in ("job_logging", "hydra_logging") if _plain(config.hydra[key]) != _NO_LOGGING]
    if _select(config, "run.dir") != ".":
        bad.append("run.dir")
    sweeper = _plain(config.hydra.sweeper)
    sweeper = sweeper if isinstance(sweeper, Mapping) else {}
    params = sweeper.get("params") or {}
    ours = {key: value for key, value in sweeper.items() if key not in _SWEEPER_KEYS} == _SWEEPER
    if not ours or not isinstance(params, Mapping) or any(_is_more_than_a_value(value) for value in params.values()):
        bad.append("sweeper")
    if bad:
        raise ConfigError(
            f"hydra.{key}: a config cannot name code, nor change what starts it; --plugin names code, and you may set "
            "hydra.sweeper.workers, .address and .params, whose values are texts or numbers"
            for key in bad
        )
    address = sweeper["address"]
    if not isinstance(address, str | None):
        raise ConfigError(
            [
                f"hydra.sweeper.address: must be that of a Dask scheduler, as tcp://127.0.0.1:8786, or null; found "
                f"{quoted(address)}"
            ]
        )


def _select(config: DictConfig, key: str) -> Any:
    return OmegaConf.select(config.hydra, key)


def _is_more_than_a_value(value: Any) -> bool:
    """Tell whether a value of the sweeper's, which becomes an override, is a group or would be resolved once more."""
    return isinstance(value, Mapping) or "${" in str(value)


def _plain(node: Any) -> Any:
    return OmegaConf.to_container(node, resolve=True) if OmegaConf.is_config(node) else node
