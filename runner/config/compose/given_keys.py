"""Keys that the command line or an experiment sets, and references between keys."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from runner.base.bounded_yaml import CONFIG, read_yaml
from runner.base.dotted_keys import dotted, leaves, split_override
from runner.base.paths import conf_dir
from runner.config.compose.files import place_in
from runner.config.compose.unresolved import read_unresolved
from runner.config.composed import Composed

_NO_KEYS = ("defaults", "hydra")
_REFERENCE = re.compile(r"\$\{([\w.]+)\}")


def given_keys(composed: Composed) -> dict[str, str]:
    """Return the dotted keys that the command line or an experiment set, each with its origin.

    A chosen option, as in wrist_sensor=mini40, counts as its group. The origin is the override, or experiment=NAME.
    """
    found: dict[str, str] = {}
    if name := composed.choices.get("experiment"):
        content = _content_of("experiment", name, composed.config_dirs)
        keys = [dotted(place) for place, _ in leaves(content, lists=False) if place[0] not in _NO_KEYS]
        found |= dict.fromkeys(keys, f"experiment={name}")
    for override in composed.overrides:
        key, _ = split_override(override)
        value = _mapping(override) if "{" in override else None
        inner = [dotted(place) for place, _ in leaves(value, lists=False)] if isinstance(value, dict) else []
        found |= dict.fromkeys([f"{key}.{name}" for name in inner] or [key], override)
    return found


def _mapping(override: str) -> object:
    from runner.config.compose.composer import parse  # imports Hydra

    return parse([override])[0].value()


def swept_keys(composed: Composed) -> list[str]:
    """Return the keys to which the chosen experiments give several values, which `runner -m` sweeps."""
    if not any(text.startswith("experiment=") for text in composed.overrides):
        return []
    params = read_unresolved(composed.overrides, composed.config_dirs, composed.root).params
    return [dotted(place) for place, _ in leaves(params, lists=False)]


def references_in(composed: Composed) -> set[str]:
    """Return the dotted keys to which values of a config refer, as in ${robot.period}."""
    unresolved = read_unresolved(composed.overrides, composed.config_dirs, composed.root).values
    values = (value for place, value in leaves(unresolved) if place[0] not in _NO_KEYS and isinstance(value, str))
    return {key for value in values for key in _REFERENCE.findall(value)}


def _content_of(group: str, option: str, config_dirs: Sequence[Path]) -> Mapping[str, object]:
    """Return the keys in the file of an option; none if a folder has no such file."""
    for folder in (*config_dirs, conf_dir()):
        path = place_in(folder, f"{group}/{option}.yaml")
        if path.is_file():
            return read_yaml(path.read_text(), path, CONFIG) or {}
    return {}
