"""A config before its references are resolved: composed by Hydra, or read without importing it.

Hydra, OmegaConf and their grammars take a third of the time of a short command. They are not needed if an earlier
process has kept the chosen options, and every override gives a plain value, such as 0.5, 20ms, thesis or [0.5,1].
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.base.dotted_keys import check_references, get
from runner.config.compose.files import groups, user_overrides
from runner.config.compose.kept_options import RUN, files_of, key_of, read_content
from runner.config.compose.overrides import prepare
from runner.plugins.discovery import in_use

if TYPE_CHECKING:
    from omegaconf import DictConfig


@dataclass(frozen=True)
class Unresolved:
    """A composed config as plain data with unresolved references.

    Attributes:
        values: The config, without Hydra's own node; the caller may change it.
        choices: The option of each group, including groups of Hydra.
        params: Keys with several values that the chosen experiments sweep.
    """

    values: dict[str, Any]
    choices: Mapping[str, str | None]
    params: Mapping[str, Any]


def read_unresolved(overrides: Sequence[str], config_dirs: Sequence[Path], root: str) -> Unresolved:
    """Return the config of overrides.

    Args:
        overrides: Hydra overrides.
        config_dirs: Config folders of the user, as absolute paths.
        root: Name of the root file in conf/.

    Raises:
        ConfigError: see `Composer.load`.
    """
    found = read_kept(overrides, tuple(config_dirs), root)
    if found is None:
        from runner.config.compose.composer import Composer

        found = from_hydra(Composer(config_dirs, root).load(overrides))
    return found


def from_hydra(config: "DictConfig") -> Unresolved:
    """Return a config that Hydra composed, with its own node."""
    from omegaconf import OmegaConf

    values: Any = OmegaConf.to_container(config, resolve=False)
    hydra = values.pop("hydra")
    return Unresolved(values, hydra["runtime"]["choices"], hydra["sweeper"].get("params") or {})


def read_kept(overrides: Sequence[str], config_dirs: tuple[Path, ...], root: str) -> Unresolved | None:
    """Return the config of plain overrides from kept options; None if Hydra must compose it. See `read_unresolved`."""
    options: list[str] = []
    values: list[tuple[str, Any]] = []
    known = groups(config_dirs)
    for line in (*user_overrides(), *prepare(overrides)):
        match = _LINE.fullmatch(line)
        if match is None or match[1].startswith("hydra"):
            return None
        if match[1] in known:
            if not _OPTION.fullmatch(match[2]):
                return None
            options.append(line)
        else:
            try:
                values.append((match[1], plain_value(match[2])))
            except ValueError:
                return None
    files = files_of(config_dirs)
    if files is None or in_use():
        return None
    try:
        kept = _kept(config_dirs, tuple(sorted(options, key=lambda line: line.partition("=")[0])), root, files)
    except LookupError:
        return None
    config = dict(kept)
    hydra = config.pop("hydra")
    if not all(_put(config, key.split("."), value) for key, value in values):
        return None
    check_references(config)
    return Unresolved(config, hydra["runtime"]["choices"], hydra["sweeper"].get("params") or {})


@lru_cache(maxsize=64)
def _kept(config_dirs: tuple[Path, ...], options: tuple[str, ...], root: str, files: object) -> dict[str, Any]:
    """Return composed options that an earlier process has kept, which must not be changed.

    Raises:
        LookupError: if there are none yet, or they are damaged.
    """
    content = read_content(key_of(config_dirs, options, root, RUN, files)) or {}
    if not all(isinstance(get(content, key), dict) for key in ("hydra.runtime.choices", "hydra.sweeper")):
        raise LookupError
    return content


_LINE = re.compile(r"([A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*)=(.+)")
_OPTION = re.compile(r"[A-Za-z_]\w*(?:/\w+)*")
_WHOLE = re.compile(r"-?(?:0|[1-9]\d*)")
_DECIMAL = re.compile(r"-?(?:0|[1-9]\d*)(?:\.\d+(?:[eE][+-]?\d+)?|[eE][+-]?\d+)")
_TEXT = re.compile(r"[A-Za-z_]\w*|(?:0|[1-9]\d*)(?:\.\d+)?(?:ms|us|s|mm|m|deg|rad)|(?=[^/]*/)[A-Za-z_/.][\w/.-]*")
_QUOTED = re.compile(r"'([^'\\$]*)'")
_LIST = re.compile(r"\[([^\[\]'{}]+)\]")
_WORDS = {"null": None, "true": True, "false": False}


def plain_value(text: str) -> str | float | bool | list[Any] | None:
    """Return the value of an override as Hydra reads it.

    Raises:
        ValueError: for a value that only Hydra's grammar can read.
    """
    if values := _LIST.fullmatch(text):
        return [plain_value(value.strip(" ")) for value in values[1].split(",")]
    if quoted := _QUOTED.fullmatch(text):
        return quoted[1]
    if text.lower() in (*_WORDS, "nan", "inf"):
        if text in _WORDS:
            return _WORDS[text]
        raise ValueError(text)
    if _WHOLE.fullmatch(text):
        return int(text)
    if _DECIMAL.fullmatch(text):
        return float(text)
    if _TEXT.fullmatch(text):
        return text
    raise ValueError(text)


def _put(config: dict[str, Any], keys: Sequence[str], value: object) -> bool:
    """Put a value into a config; what lies on its path is copied. Return False if Hydra must do it."""
    for key in keys[:-1]:
        inner = config.get(key, {})
        if not isinstance(inner, dict):
            return False
        config[key] = dict(inner)
        config = config[key]
    present = config.get(keys[-1])
    if isinstance(present, dict) or (isinstance(present, list) and not isinstance(value, list)):
        return False
    config[keys[-1]] = value
    return True
