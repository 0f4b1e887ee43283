"""Config composition with Hydra, from the groups in conf/ and a list of overrides.

The chosen options determine the files of a config, and Hydra takes about 50 ms for them. The config of each choice of
options is cached. Hydra's own function then applies the overrides of values to a copy, in about 1 ms.
"""

import pickle
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from hydra import initialize_config_dir
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra.core.config_loader import ConfigLoader
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import ChoiceSweep, Glob, Override, Sweep
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from runner.base.dotted_keys import check_references
from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.base.sanitize import quoted
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain_options
from runner.config.compose.files import groups, user_overrides
from runner.config.compose.kept_options import files_of, key_of, read_options, write_options
from runner.config.compose.overrides import force, prepare
from runner.config.compose.shortcuts import KeptRepository, kept_files, take_shortcuts
from runner.config.compose.sources import VERSION_BASE, checked_sources
from runner.plugins.discovery import in_use

_KEPT = 512  # combinations of options, about 30 kB each
_SWEEPER = (
    ("address", str, "that of a Dask scheduler, as tcp://127.0.0.1:8786"),
    ("params", Mapping, "keys with their values"),
)


class Composer:
    """Composes configs from the groups in conf/ and in config folders of the user.

    Args:
        config_dirs: Config folders of the user.
        root: Name of the root file in conf/: "config" for a run, "calibrate" for a calibration.

    Attributes:
        config_dirs: Config folders of the user, as absolute paths.
    """

    def __init__(self, config_dirs: Sequence[Path] = (), root: str = "config") -> None:
        take_shortcuts()
        self.config_dirs, self._root = tuple(folder.resolve() for folder in config_dirs), root

    @property
    def hydra(self) -> ConfigLoader:
        """Hydra's own loader, which reads files as checked_sources does."""
        folder = str(conf_dir())
        with checked_sources(self.config_dirs), initialize_config_dir(folder, job_name="runner", **VERSION_BASE):
            return GlobalHydra.instance().config_loader()

    def load(self, overrides: Sequence[str], root: str = "", mode: RunMode = RunMode.RUN) -> DictConfig:
        """Return the config that Hydra composes, with its own node; the caller may change it.

        Args:
            overrides: Hydra overrides.
            root: Name of the root file in conf/; "" for that of the composer.
            mode: Run mode of Hydra; MULTIRUN leaves out overrides with several values.

        Raises:
            ConfigError: for an unknown option, a value that cannot be parsed, a file that is not YAML or sets a key
                that no file may set, and a config that refers to itself.
        """
        lines = [*user_overrides(), *prepare(overrides)]
        known = groups(self.config_dirs)
        options: list[Override] = []
        try:
            parsed = parse(lines)
            for override in parsed:
                check_functions(override)
            if mode == RunMode.MULTIRUN:
                parsed = [each for each in parsed if not each.is_sweep_override() or each.is_hydra_override()]
            options = [each for each in parsed if _chooses_option(each, known)]
            values = [str(each.input_line) for each in parsed if each not in options]
            config = self._of_options(options, root or self._root, mode)
            put_values(config, values)
            check_composed(config)
        except COMPOSITION_ERRORS as error:
            chosen = {each.key_or_group: each.value() for each in options}
            raise explain_options(error, chosen, self.config_dirs) from None
        except (TypeError, KeyError, IndexError, AttributeError, AssertionError) as error:
            found = f"{type(error).__name__} {error}".strip()
            raise ConfigError(f"Hydra cannot compose the config: {found}; look at what is unusual in it") from error
        return config

    def sweeper(self, overrides: Sequence[str]) -> DictConfig:
        """Return the config of the sweeper for `runner -m OVERRIDES`.

        Raises:
            ConfigError: see `load`.
        """
        config: DictConfig = self.load(overrides, mode=RunMode.MULTIRUN).hydra.sweeper
        return config

    def _of_options(self, options: Sequence[Override], root: str, mode: RunMode) -> DictConfig:
        # The last option of a group counts. The order of the groups has no effect.
        lines = tuple(str(each.input_line) for each in sorted(options, key=lambda each: each.key_or_group))
        files = files_of(self.config_dirs)
        load = _load_options if files is not None else _load_options.__wrapped__
        others = files, in_use()
        config: DictConfig = pickle.loads(load(self.config_dirs, lines, root, mode, *others))  # noqa: S301
        return config


def parse(overrides: Sequence[str]) -> list[Override]:
    """Return overrides parsed by Hydra; callers must not change them.

    Raises:
        OverrideParseException: for an invalid override.
    """
    return [_parse(text) for text in overrides]


@lru_cache(maxsize=2 * _KEPT)
def _parse(text: str) -> Override:
    return OverridesParser.create().parse_overrides([text])[0]


def check_functions(override: Override) -> None:
    """Check that no value of a list or mapping is a function of Hydra, such as choice(1,2).

    Raises:
        ConfigError: if there is such a value; Hydra would fail on it without naming the key.
    """
    value = override.value()
    if any(map(_has_function, value.list if isinstance(value, ChoiceSweep) else _inner(value))):
        raise ConfigError(
            f"{override.key_or_group}: a function inside a list of values ({quoted(override.get_value_string())}). "
            "Allowed: one function that has all values, such as choice(1,2,3), or only values, such as 1,2,3"
        )


def _has_function(value: object) -> bool:
    return isinstance(value, Sweep | Glob) or any(map(_has_function, _inner(value)))


def _inner(value: object) -> Iterable[object]:
    return value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()


def put_values(config: DictConfig, overrides: Sequence[str]) -> None:
    """Put the values of overrides into a config that Hydra composed, including values of unknown keys.

    Raises:
        ConfigError: see `prepare`.
        Exception: one of COMPOSITION_ERRORS, as Hydra raises it.
    """
    for override in parse(force(overrides)):
        if not override.is_delete():
            _detach(config, override.key_or_group)
        ConfigLoaderImpl._apply_overrides_to_config([override], config)


def _detach(config: DictConfig, key: str) -> None:
    """Replace a reference on the path to a key by an empty mapping, as OmegaConf 2.3 does.

    OmegaConf 2.4 would put the value into the mapping that it refers to, which other keys share.
    """
    node: Any = config
    for part in key.split(".")[:-1]:
        if not isinstance(node, DictConfig) or part not in node.keys():  # noqa: SIM118 - `in` resolves references
            return
        if OmegaConf.is_interpolation(node, part):
            node[part] = {}
            return
        node = node._get_node(part)


def check_composed(config: DictConfig) -> None:
    """Check a config that Hydra composed, before any reference in it is resolved.

    Raises:
        ConfigError: for a key that refers to itself or expands to too much, and for a wrong value of the sweeper.
    """
    plain: Any = OmegaConf.to_container(config, resolve=False)
    check_references(plain)
    for key, kind, wanted in _SWEEPER:
        value = OmegaConf.select(config, f"hydra.sweeper.{key}")
        found = OmegaConf.to_container(value, resolve=True) if OmegaConf.is_config(value) else value
        if not isinstance(found, kind | None):
            raise ConfigError(f"hydra.sweeper.{key}: must be {wanted}, or null; found {quoted(found)}")


def _chooses_option(override: Override, known: Sequence[str]) -> bool:
    """Return True if an override chooses or removes an option of a group; a mapping contains values instead.

    Also True for several values, which Hydra rejects in a single run.
    """
    key = override.key_or_group
    is_group = key in known or "/" in key or override.package is not None
    return override.is_sweep_override() or (is_group and not isinstance(override.value(), dict))


@lru_cache(maxsize=_KEPT)
def _load_options(
    config_dirs: tuple[Path, ...], options: tuple[str, ...], root: str, mode: RunMode, files: object, *others: object
) -> bytes:
    """Return the pickled config that Hydra composes from options, or that an earlier process has kept.

    Besides the state of the files, None if it is unknown, the plug-ins decide the result.
    """
    key = key_of(config_dirs, options, root, mode, files) if files is not None and not any(others) else None
    config = read_options(key) if key else None
    if config is None:
        loader: Any = Composer(config_dirs).hydra
        if files is not None:
            kept = kept_files(config_dirs, files, *others)
            with checked_sources(config_dirs):
                loader.repository = KeptRepository(loader.config_search_path, kept)
        config = loader.load_configuration(root, list(options), mode, from_shell=False)
        if key:
            write_options(key, config)
    try:
        return pickle.dumps(config)
    except RecursionError:
        check_composed(config)  # reports that it is nested too deeply
        raise
