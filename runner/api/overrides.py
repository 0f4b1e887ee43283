"""Python values as Hydra overrides."""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path, PurePath
from typing import TypeVar

import numpy as np
from hydra.core.override_parser.types import Quote, QuotedString

from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.store.axes import SweepAxis, override_value

T = TypeVar("T", bound="str | SweepAxis")
_KEY = re.compile(r"[A-Za-z_][\w.@/]*")
_BARE = re.compile(r"[\w./+-]+", re.ASCII)
_ALLOWED = "a number, text, bool, None, Path, list, tuple, dict or NumPy array"


class _WrittenError(Exception):
    """A value that no override can hold."""


def run_overrides(given: Sequence[str], values: Mapping[str, object]) -> list[str]:
    """Return the overrides of one run: first those given as strings, then those given as keywords.

    A keyword is a key with two underscores instead of each dot: `controller__period=0.01` sets controller.period. A
    string has the same meaning as on the command line after `KEY=`; a Path is taken literally.

        >>> run_overrides(["noise=thesis"], {"robot": "macro", "controller__period": 0.01, "torque_limits.max": [1, 2]})
        ['noise=thesis', 'robot=macro', 'controller.period=0.01', 'torque_limits.max=[1,2]']

    Raises:
        ConfigError: if a key or value cannot be written as an override; lists all such keys and values.
    """
    return _overrides(given, values, _one)


def sweep_overrides(given: Sequence[str], values: Mapping[str, object]) -> list[str | SweepAxis]:
    """Return the overrides of a sweep: as for a run, but a list, tuple, range or array is an axis of typed values.

    A single value that is itself a list must be wrapped in another list.

        >>> sweep_overrides([], {"robot": "macro", "seed": range(20), "torque_limits__max": [[1, 2, 3]]})[1:]
        [SweepAxis(key='seed', values=range(0, 20)), SweepAxis(key='torque_limits.max', values=[[1, 2, 3]])]
    """
    return _overrides(given, values, _axis)


def tuning_overrides(given: Sequence[str], values: Mapping[str, object]) -> list[str]:
    """Return the overrides of a tuning: as for a run, but a tuple of two numbers is the range of a tuned key.

    >>> tuning_overrides([], {"robot": "macro", "controller__natural_frequency": (5, 50)})
    ['robot=macro', 'controller.natural_frequency=interval(5,50)']
    """
    return _overrides(given, values, _interval)


def _overrides(given: Sequence[str], values: Mapping[str, object], entry: Callable[[str, object], T]) -> list[str | T]:
    problems = [
        f"{quoted(each)} is not a valid override; write KEY=VALUE as a string"
        for each in given
        if type(each) is not str
    ]
    found: list[str | T] = list(given)
    for name, value in values.items():
        key = name.replace("__", ".")
        if not _KEY.fullmatch(key):
            problems.append(
                f"{quoted(name)} is not a key; write controller__period=... or **{{'controller.period': ...}}"
            )
            continue
        try:
            found.append(entry(key, value))
        except _WrittenError as error:
            problems.append(f"{key}: {error}")
    if problems:
        raise ConfigError(problems)
    return found


def _one(key: str, value: object) -> str:
    return f"{key}={_text(value)}"


def _axis(key: str, value: object) -> str | SweepAxis:
    if isinstance(value, np.ndarray) and value.ndim:
        value = list(value)
    if not isinstance(value, list | tuple | range):
        return _one(key, value)
    if not value:
        raise _WrittenError("is swept over no value; give one or more")
    return SweepAxis(key, value if isinstance(value, range) else [_plain(each) for each in value])


def _interval(key: str, value: object) -> str:
    if not isinstance(value, tuple):
        return _one(key, value)
    if len(value) != 2:
        raise _WrittenError(f"a range has two ends, (low, high); found {quoted(value)}")
    return f"{key}=interval({_text(value[0])},{_text(value[1])})"


def _text(value: object) -> str:
    """Return a value as written after `KEY=`; a string is returned unchanged, in a list it is always one value.

    A path is always quoted: its name may be that of a number.
    """
    if type(value) is str:
        return value
    return override_value(_plain(value), _quote if isinstance(value, PurePath) else _letters)


def _plain(value: object) -> object:
    """Return a value without NumPy and paths, with strings that Hydra reads literally; lists and mappings in it too."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if value is None or isinstance(value, bool | int | float):
        return value
    if isinstance(value, PurePath | str):
        return str(value).replace("${", r"\${")
    if isinstance(value, list | tuple | range):
        return [_plain(each) for each in value]
    if isinstance(value, Mapping):
        return {_name(key): _plain(each) for key, each in value.items()}
    raise _WrittenError(f"cannot be written as an override: found {quoted(value)}; allowed: {_ALLOWED}")


def _name(key: object) -> str:
    if not (isinstance(key, str) and _KEY.fullmatch(key)):
        raise _WrittenError(f"cannot be written as an override: {quoted(key)} is not the name of a key")
    return key


def _letters(text: str) -> str:
    """Return a string as one Hydra value, quoted if it contains more than a name or a number."""
    return text if _BARE.fullmatch(text) else _quote(text)


def _quote(text: str) -> str:
    return QuotedString(text, Quote.single).with_quotes()


def config_folders(given: "Sequence[str | Path] | str | Path") -> list[Path]:
    """Return the user's config folders as paths.

    Raises:
        ConfigError: if a folder does not exist.
    """
    folders = [Path(each) for each in ([given] if isinstance(given, str | Path) else given)]
    missing = [f"config_dirs: no folder {folder}" for folder in folders if not folder.is_dir()]
    if missing:
        raise ConfigError(missing)
    return folders
