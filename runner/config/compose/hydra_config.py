"""Configs composed by Hydra, with a cache of the config for each choice of options.

The chosen options determine the files of a config, and Hydra takes about 100 ms for them. Value overrides are put into
a copy in about 1 ms. Hydra composes everything else, and every line that fails, as a whole.
"""

import os
import pickle
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import islice
from pathlib import Path

from hydra import initialize_config_dir
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from runner.base.engines import default_plant
from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.config.compose.no_code import check_composed, code_refused
from runner.config.compose.options import groups
from runner.config.compose.user_settings import user_overrides

_KEPT = 512  # combinations of options, some 30 kB each
_MOST = 1000  # files and folders in the config folders; where there are more, Hydra composes each time

Files = tuple[tuple[str, int, int], ...]  # path, time of change in ns, size


def hydra_config(
    overrides: Sequence[str], config_dirs: Sequence[Path] = (), root: str = "config", mode: RunMode = RunMode.RUN
) -> DictConfig:
    """Return the config that Hydra composes, with its own node; the caller may change it.

    Args:
        overrides: Hydra overrides, as `force` leaves them.
        config_dirs: Config folders of the user.
        root: Name of the file in conf/ that the groups hang on.
        mode: MULTIRUN leaves out what is swept.

    Raises:
        ConfigError: for a config that sets what no file may, or refers to itself.
        Exception: one of COMPOSITION_ERRORS, as Hydra raises it for what it cannot compose.
    """
    overrides = [*user_overrides(), *overrides]
    folders = tuple(folder.resolve() for folder in config_dirs)
    found = _with_values(overrides, folders, root, mode)
    return _compose(overrides, folders, root, mode) if found is None else found


def parse(overrides: Sequence[str]) -> list[Override]:
    """Return overrides as Hydra reads them; they must not be changed.

    Raises:
        OverrideParseException: for what is no override.
    """
    return [_parse(text) for text in overrides]


@lru_cache(maxsize=2 * _KEPT)
def _parse(text: str) -> Override:
    return OverridesParser.create().parse_overrides([text])[0]


def _with_values(
    overrides: Sequence[str], config_dirs: tuple[Path, ...], root: str, mode: RunMode
) -> DictConfig | None:
    """Return the kept config of the options with the values of the others; None for a line that Hydra must take."""
    parsed = parse(overrides)
    if mode == RunMode.MULTIRUN:
        parsed = [each for each in parsed if not each.is_sweep_override() or each.is_hydra_override()]
    known = groups(config_dirs)
    options = [each for each in parsed if _chooses_option(each, known)]
    options.sort(key=lambda each: each.key_or_group)  # of one group the last counts; of several the order does not
    values = [each for each in parsed if not _chooses_option(each, known)]
    files = _files(conf_dir(), *config_dirs)
    if files is None or any(each.is_sweep_override() for each in parsed) or not all(map(_is_put, values)):
        return None
    lines = tuple(str(each.input_line) for each in options)
    try:
        kept = _of_options(lines, config_dirs, root, mode, files, default_plant())
    except ConfigError:
        return None  # a value may mend it
    config: DictConfig = pickle.loads(kept)  # noqa: S301 - made below
    try:
        for each in values:
            OmegaConf.update(config, each.key_or_group, each.value(), merge=True, force_add=each.is_force_add())
        check_composed(config)
    except Exception:
        return None  # Hydra says why
    return config


def _chooses_option(override: Override, known: Sequence[str]) -> bool:
    """Tell if an override chooses or removes an option of a group; a mapping in its place holds values."""
    key = override.key_or_group
    is_group = key in known or "/" in key or override.package is not None
    return is_group and not isinstance(override.value(), dict)


def _is_put(override: Override) -> bool:
    """Tell if all that an override does is to put a value at its key."""
    return override.is_force_add() or not (override.is_add() or override.is_delete())


@lru_cache(maxsize=_KEPT)
def _of_options(options: tuple[str, ...], config_dirs: tuple[Path, ...], root: str, mode: RunMode, *_: object) -> bytes:
    """Return the config of some options, pickled.

    The last arguments are what else it follows from: the files as they are, and the plant that `default` stands for.
    """
    return pickle.dumps(_compose(options, config_dirs, root, mode))


def _compose(overrides: Sequence[str], config_dirs: Sequence[Path], root: str, mode: RunMode) -> DictConfig:
    """Return what Hydra composes."""
    search = [f"hydra.searchpath=[{','.join(f'file://{folder}' for folder in config_dirs)}]"]
    lines = [*overrides, *(search if config_dirs else [])]
    with code_refused(), initialize_config_dir(str(conf_dir()), version_base="1.3", job_name="runner"):
        loader = GlobalHydra.instance().config_loader()
        return loader.load_configuration(root, lines, mode, from_shell=False)


def _files(*folders: Path) -> Files | None:
    """Return what is in some folders; None where that is too much to look at, or is not there."""
    try:
        found = tuple(islice((each for folder in folders for each in _below(folder)), _MOST + 1))
    except OSError:
        return None
    return found if len(found) <= _MOST else None


def _below(folder: Path | str) -> Iterator[tuple[str, int, int]]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir():
                yield entry.path, 0, 0
                yield from _below(entry.path)
            else:
                status = entry.stat()
                yield entry.path, status.st_mtime_ns, status.st_size
