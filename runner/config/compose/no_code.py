"""Security checks of untrusted config files: code, environment variables, paths and size.

Hydra would instantiate the objects that some of its keys name, and import the modules on its search path.
"""

import contextlib
import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.config_repository import ConfigRepository
from hydra._internal.sources_registry import SourcesRegistry
from hydra.core.plugins import Plugins
from hydra.plugins.config_source import ConfigResult, ConfigSource
from omegaconf import DictConfig, OmegaConf

from runner.base.bounded_yaml import CONFIG, YamlError, check_yaml
from runner.base.cache import Memory
from runner.base.engines import default_plant
from runner.base.errors import ConfigError
from runner.base.interpolation import check_references
from runner.base.limits import ExcessError, read_text
from runner.base.paths import check_inside, conf_dir, ships
from runner.base.sanitize import quoted
from runner.config.compose.options import place_in
from runner.config.compose.user_settings import refuse_settings

_SWEEPER = (
    ("address", str, "that of a Dask scheduler, as tcp://127.0.0.1:8786"),
    ("params", Mapping, "keys with their values"),
)
_READ = Memory(512)  # files as Hydra parses them, pickled


@contextlib.contextmanager
def code_refused() -> Iterator[None]:
    """Let Hydra go on only with config files that name no code and lie in their folders, whatever package they take.

    In the folder of a study, experiments have the study's name; see study_folder. The one function that a file calls,
    conf/plant/default.yaml, is ours.
    """
    Plugins.instance()  # registers what reads files, as a class of Hydra's own making
    OmegaConf.register_new_resolver("default_plant", lambda: f"/plant/{default_plant()}", replace=True)
    files = SourcesRegistry.instance().resolve("file")
    load, load_one = ConfigLoaderImpl.load_configuration, ConfigLoaderImpl._load_single_config
    load_name = ConfigRepository.load_config
    load_file, is_config, is_group = files.load_config, files.is_config, files.is_group

    def checked_load(self: ConfigLoaderImpl, *args: Any, **options: Any) -> DictConfig:
        try:
            config = load(self, *args, **options)
        except (TypeError, KeyError, IndexError, AttributeError, AssertionError, RecursionError) as error:
            found = f"{type(error).__name__} {error}".strip()
            raise ConfigError([f"Hydra cannot compose the config: {found}; look at what is unusual in it"]) from error
        check_composed(config)
        return config

    def checked_one(self: ConfigLoaderImpl, default: Any, repo: Any) -> ConfigResult:
        result = load_one(self, default, repo)  # in its package
        scheme, _, folder = str(result.path).partition("://")
        if scheme == "file":
            place = place_in(Path(folder), default.config_path)
            _check_settings(result.config, Path(folder) / ConfigSource._normalize_file_name(place))
        return result

    def checked_name(self: ConfigRepository, config_path: str) -> ConfigResult | None:
        if config_path.startswith("/") or ".." in config_path.split("/"):  # for any source, Hydra's own as well
            named = f"{quoted(config_path)}: no config of a folder; a defaults list or an override names it"
            raise ConfigError([f"{named}; allowed: names without '..' and '/' in front"])
        _refuse_two_of_a_name(self.sources, config_path)
        return load_name(self, config_path)

    def load_sound(self: ConfigSource, path: Path, place: str) -> bytes:
        try:
            if not ships(path):
                check_yaml(read_text(path, CONFIG.size), path)
            return pickle.dumps(load_file(self, place))
        except YamlError as error:
            raise ConfigError([str(error)]) from None
        except ExcessError as error:
            raise ConfigError([f"{path}: {error}"]) from None
        except UnicodeDecodeError as error:
            raise ConfigError([f"{path}: is no text: {error}"]) from None
        except OSError as error:
            raise ConfigError([f"{path}: {error.strerror or 'holds no mapping of keys'}"]) from None

    def checked_read(self: ConfigSource, config_path: str) -> ConfigResult:
        place = place_in(Path(self.path), config_path)
        path = Path(self.path) / self._normalize_file_name(place)
        if not path.is_file():
            return load_file(self, place)  # raises
        check_inside(path, [Path(self.path)])
        status = path.stat()
        key = (self.provider, self.path, place, status.st_mtime_ns, status.st_size)
        result: ConfigResult = pickle.loads(_READ.known(key, lambda: load_sound(self, path, place)))  # noqa: S301
        if not ships(path):
            refuse_settings(_groups(result.config), path)
        if "/" not in config_path:  # a primary config, which could name folders to search at once
            _check_settings(result.config, path)
        return result

    with (
        _replaced(ConfigLoaderImpl, checked_load, "load_configuration"),
        _replaced(ConfigLoaderImpl, checked_one, "_load_single_config"),
        _replaced(ConfigRepository, checked_name, "load_config"),
        _replaced(files, checked_read, "load_config"),
        _replaced(
            files, lambda self, config_path: is_config(self, place_in(Path(self.path), config_path)), "is_config"
        ),
        _replaced(files, lambda self, config_path: is_group(self, place_in(Path(self.path), config_path)), "is_group"),
    ):
        yield


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
        ConfigError: for a key that refers to itself or stands for too much, and a value of the sweeper that is none.
    """
    plain: Any = OmegaConf.to_container(config, resolve=False)
    check_references(plain)
    for key, kind, wanted in _SWEEPER:
        value = OmegaConf.select(config, f"hydra.sweeper.{key}")
        found = OmegaConf.to_container(value, resolve=True) if OmegaConf.is_config(value) else value
        if not isinstance(found, kind | None):
            raise ConfigError([f"hydra.sweeper.{key}: must be {wanted}, or null; found {quoted(found)}"])


def _refuse_two_of_a_name(sources: Sequence[ConfigSource], config_path: str) -> None:
    """Refuse an option of a config folder that has the name of one of ours: nobody could say which of them ran."""
    group, _, option = config_path.rpartition("/")
    found = [
        Path(source.path) for source in sources if group and source.scheme() == "file" and source.is_config(config_path)
    ]
    own = [folder for folder in found if folder.resolve() != conf_dir()]
    if own and len(own) < len(found):
        path = own[0] / ConfigSource._normalize_file_name(place_in(own[0], config_path))
        raise ConfigError([f"{group}: '{option}' is one of ours, and {path} has the same name; rename that file"])


def _check_settings(config: Any, path: Path) -> None:
    """Check that a config file, in its package, says nothing of how or where runs are made; ours may."""
    plain: Any = {} if ships(path) else OmegaConf.to_container(config, resolve=False)
    refuse_settings(_keys({root: plain[root] for root in ("hydra", "outputs") if root in plain}), path)


def _groups(config: Any) -> Iterator[str]:
    """Yield the groups and files that the defaults list of a config file names."""
    for entry in (config.get("defaults") if isinstance(config, DictConfig) else None) or ():
        yield from (str(text).split()[-1].lstrip("/") for text in (entry if isinstance(entry, Mapping) else [entry]))


def _keys(values: Mapping[str, Any], place: str = "") -> Iterator[str]:
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from _keys(value, f"{place}{key}.")
        else:
            yield f"{place}{key}"
