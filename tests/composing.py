"""Configs composed faster than by Hydra alone, where composing takes most of the time of a short run.

A YAML text is parsed once in a process. Hydra composes every combination of options once; overrides of values are
applied to a copy, by Hydra's own function for them. What is neither an option nor a value goes to Hydra as ever.
`test_composing.py` compares both ways; what is about Hydra itself asks for the fixture `plain_hydra`.
"""

import copy
import pickle
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import yaml
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import DictConfig

from runner.config import compose as composition
from runner.config.options import groups

_hydra, _parse = composition.hydra_compose, yaml.load
_groups = frozenset(groups())
_composed: dict[tuple[str, ...], DictConfig] = {}
_parsed: dict[tuple[str | bytes, str], bytes] = {}


def parse_once(stream: Any, Loader: Any) -> Any:
    """Do what yaml.load does; the same text gives equal objects, which nobody else has."""
    text = stream if isinstance(stream, str | bytes) else stream.read()
    key = (text, Loader.__qualname__)  # OmegaConf makes its class anew each time
    if key not in _parsed:
        if text is not stream:
            stream.seek(0)  # parsed from the stream itself, so that errors name the file
        _parsed[key] = pickle.dumps(_parse(stream, Loader))
    return pickle.loads(_parsed[key])


def compose_quickly(root: str, overrides: Sequence[str], return_hydra_config: bool) -> DictConfig:
    """Do what Hydra's compose does with overrides as `force` leaves them."""
    options = [override for override in overrides if not override.startswith("++")]
    values = OverridesParser.create().parse_overrides([value for value in overrides if value.startswith("++")])
    if any(value.is_sweep_override() for value in values) or not {o.partition("=")[0] for o in options} <= _groups:
        return _hydra(root, list(overrides), return_hydra_config=return_hydra_config)
    if (root, *options) not in _composed:
        _composed[root, *options] = _hydra(root, options, return_hydra_config=True)
    config = copy.deepcopy(_composed[root, *options])
    ConfigLoaderImpl._apply_overrides_to_config(values, config)
    return config


def begin() -> None:
    """Compose quickly from here on."""
    yaml.load, composition.hydra_compose = parse_once, compose_quickly


@contextmanager
def plainly() -> Iterator[None]:
    """Compose by Hydra alone for a while."""
    yaml.load, composition.hydra_compose = _parse, _hydra
    yield
    begin()
