"""Files of configs read once in a process, which takes most of the time in which Hydra composes a config.

A YAML text or an interpolation is parsed once, and each of our files is taken apart once. What Hydra makes of the
chosen options alone is made once, for the files as they are; values that overrides set are put there by Hydra as ever.
`test_composing.py` compares both ways; what is about Hydra itself asks for the fixture `plain_hydra`.
"""

import copy
import functools
import hashlib
import pickle
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml
from hydra._internal import config_loader_impl as loading
from hydra._internal import defaults_list
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.config_repository import ConfigRepository
from hydra._internal.defaults_list import DefaultsList, Overrides
from hydra.core.object_type import ObjectType
from omegaconf import _utils, base, grammar_parser

from runner.paths import conf_dir

_parse = yaml.load
_choose, _merge = loading.create_defaults_list, ConfigLoaderImpl._compose_config_from_defaults_list
_load, _name_choices = ConfigRepository.load_config, defaults_list._create_interpolation_map
_parse_grammar = functools.cache(grammar_parser.parse)
_parsed: dict[tuple[str | bytes, str], bytes] = {}
_loaded: dict[Any, bytes] = {}
_chosen: dict[Any, DefaultsList] = {}
_merged: dict[Any, bytes] = {}


def parse_once(stream: Any, Loader: Any) -> Any:
    """Do what yaml.load does; the same text gives equal objects, which nobody else has."""
    text = stream if isinstance(stream, str | bytes) else stream.read()
    key = (text, Loader.__qualname__)  # OmegaConf makes its class anew each time
    if key not in _parsed:
        if text is not stream:
            stream.seek(0)  # parsed from the stream itself, so that errors name the file
        _parsed[key] = pickle.dumps(_parse(stream, Loader))
    return pickle.loads(_parsed[key])


def load_once(self: Any, config_path: str) -> Any:
    """Return what a file says and what it takes from others; those that are not ours are read each time."""
    source = self._find_object_source(config_path=config_path, object_type=ObjectType.CONFIG)
    if source is None or not (source.scheme() == "pkg" or Path(source.path) == conf_dir()):
        return _load(self, config_path)
    key = (source.provider, source.full_path(), config_path)
    if key not in _loaded:
        _loaded[key] = pickle.dumps(_load(self, config_path))
    return pickle.loads(_loaded[key])


def choose_once(repo: Any, config_name: Any, overrides_list: Any, **options: Any) -> DefaultsList:
    """Return which files make a config, as Hydra does from the overrides of options, and the overrides of values."""
    values = Overrides(repo=repo, overrides_list=overrides_list).config_overrides
    others = [override.input_line for override in overrides_list if override not in values]
    key = (_files(repo), config_name, *others, *sorted(options.items()))
    if key not in _chosen:
        _chosen[key] = _choose(repo=repo, config_name=config_name, overrides_list=overrides_list, **options)
    return replace(_chosen[key], config_overrides=values)


def merge_once(self: Any, defaults: Any, repo: Any) -> Any:
    """Return what the files say together."""
    key = (_files(repo), *((default.config_path, default.package) for default in defaults))
    if key not in _merged:
        _merged[key] = pickle.dumps(_merge(self, defaults=defaults, repo=repo))
    return pickle.loads(_merged[key])


def name_choices_if_asked(overrides: Any, defaults_list: Any, self_added: bool) -> Any:
    """Return what a default may refer to; None where none refers to anything."""
    asked = any(default.is_interpolation() for default in defaults_list if not default.is_self())
    return _name_choices(overrides, defaults_list, self_added) if asked else None


def copy_sources(self: Any, _memo: Any) -> Any:
    """Return a copy that may read other files: Hydra gives it another list then."""
    return copy.copy(self)


def _files(repo: Any) -> str:
    """Return a digest of where files are read and, but for our own, of what stands in them."""
    digest = hashlib.sha256()
    for source in repo.get_sources():
        digest.update(f"{source.provider} {source.full_path()}\n".encode())
        folder = Path(source.path)
        if source.scheme() == "file" and folder != conf_dir():
            for path in sorted(folder.rglob("*.yaml")):
                digest.update(f"{path}\n".encode() + path.read_bytes())
    return digest.hexdigest()


def begin() -> None:
    """Read files once from here on."""
    yaml.load = parse_once
    base.parse = _utils.parse = _parse_grammar
    ConfigRepository.load_config, ConfigRepository.__deepcopy__ = load_once, copy_sources
    defaults_list._create_interpolation_map = name_choices_if_asked
    loading.create_defaults_list, ConfigLoaderImpl._compose_config_from_defaults_list = choose_once, merge_once


@contextmanager
def plainly() -> Iterator[None]:
    """Leave to Hydra for a while what it makes of the files."""
    ConfigRepository.load_config = _load
    del ConfigRepository.__deepcopy__
    defaults_list._create_interpolation_map = _name_choices
    loading.create_defaults_list, ConfigLoaderImpl._compose_config_from_defaults_list = _choose, _merge
    yield
    begin()
