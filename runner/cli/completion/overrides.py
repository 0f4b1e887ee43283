"""Completion of overrides: options of groups from file names, keys from the config that Hydra composes.

Slow answers are kept in the cache of compiled code while everything that they depend on is unchanged.
"""

import hashlib
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from runner.base import cache
from runner.base.paths import conf_dir, package_dir, robots_dir
from runner.config.compose.files import group_options, groups, state_of, user_overrides

_SIGN = re.compile(r"[+~]*")
_FILE = re.compile(r"^  - (\w+)\s*(?:#.*)?$", re.MULTILINE)  # of a root's defaults: a file with top-level keys
_GROUP = re.compile(r"^  - (\w+): ", re.MULTILINE)
_KEY = re.compile(r"^(\w+):[ \t]*([^\s#]?)", re.MULTILINE)
_SPEC = "spec.metrics."
_MOST = 10_000  # files that an answer may depend on; an answer with more is not kept
_GLOBAL = "# @package _global_"  # first line of a file with top-level keys


class Typed(NamedTuple):  # a dataclass would take a tenth of the time of a TAB
    """Words of a command before the word under the cursor.

    Attributes:
        overrides: Typed overrides.
        config_dirs: Existing config folders of the command.
        plugins: Plug-ins, as in "controller=mine/spring.py".
    """

    overrides: Sequence[str]
    config_dirs: Sequence[Path]
    plugins: Sequence[str]


def override_words(typed: Typed, typed_word: str, root: str) -> Iterator[str]:
    """Yield the overrides that complete a word; Hydra composes the config if the word has a key with a dot.

    Args:
        typed: The words before the word under the cursor.
        typed_word: The word under the cursor.
        root: File of conf/ that the overrides change: "config" of a run, "calibrate" of a calibration.
    """
    word = _SIGN.sub("", typed_word, count=1)
    sign = typed_word.removesuffix(word)
    key, given, value = word.partition("=")
    if given and key in groups(typed.config_dirs):
        found = _options(typed, key, value)
    elif word.startswith(_SPEC) and not given and root == "config":
        found = _bounds(word.removeprefix(_SPEC))
    elif given or "." in word:
        found = _keys(typed, word, root)
    else:
        found = _top(root)
    yield from (sign + each for each in found)


def _bounds(word: str) -> Iterator[str]:
    """Yield the metrics that a spec may bound, and after a metric the keys of a bound."""
    metric, dot, _ = word.partition(".")
    if dot:
        yield from (f"{_SPEC}{metric}.{key}=" for key in ("min", "max", "reason"))
    else:
        yield from (f"{_SPEC}{name}." for name in metric_names())


def _options(typed: Typed, group: str, value: str) -> Iterator[str]:
    """Yield the options of a group; after a comma, the options that are not in the list yet."""
    known = {*group_options(group, typed.config_dirs), *_plugins(typed.plugins, group)}
    head = value[: value.rfind(",") + 1]
    yield from (f"{group}={head}{name}" for name in known - set(head.split(",")))


def _plugins(plugins: Sequence[str], group: str) -> Iterator[str]:
    """Yield the names of the plug-ins of a group that the line names by --plugin."""
    for plugin in plugins:
        of_group, _, module = plugin.partition("=")
        if of_group == group and module:
            name = module.rpartition(":")[2]
            yield PurePath(name).stem if name.endswith(".py") else name.rpartition(".")[2]


def _top(root: str) -> Iterator[str]:
    """Yield groups and the top-level keys of a config: `key=`, or `key.` for a key with subkeys."""
    folder = conf_dir()
    text = (folder / f"{root}.yaml").read_text()
    files = [(folder / f"{name}.yaml").read_text() for name in _FILE.findall(text) if name != "_self_"]
    for key, value in _KEY.findall("\n".join([text, *files])):
        if key not in ("defaults", "hydra"):
            yield f"{key}=" if value else f"{key}."
    for group in _GROUP.findall(text):
        yield f"{group}="
        if any(not path.read_text().startswith(_GLOBAL) for path in (folder / group).glob("*.yaml")):
            yield f"{group}."


def _keys(typed: Typed, word: str, root: str) -> Iterator[str]:
    """Yield the keys that complete a word up to the next dot; after a complete key, its value."""
    key, given, _ = word.partition("=")
    whole = [each for each in typed.overrides if "=" in each]
    values: Mapping[str, str | None] = _cached(
        ["keys of", root, *whole], typed.config_dirs, lambda: dict(_compose(whole, typed.config_dirs, root))
    )
    if given:
        if values.get(key) is not None:
            yield f"{key}={values[key]}"
        return
    place = key.rfind(".") + 1
    for found in values:
        if found.startswith(key):
            name, dot, _ = found[place:].partition(".")
            yield f"{key[:place]}{name}{dot or '='}"


def metric_names() -> Iterable[str]:
    """Return the names of the built-in metrics."""

    def read() -> list[str]:
        from runner.cli.list import TOPICS

        return [*TOPICS["metrics"]([])]

    names: list[str] = _cached(["metrics"], [], read)
    return names


def _cached(question: Sequence[str], config_dirs: Sequence[Path], answer: Callable[[], Any]) -> Any:
    """Return the answer to a question from the cache; compute and keep it if it is missing."""
    key = cache_key(question, config_dirs)
    found = None if key is None else cache.read_answer(key)
    if found is None:
        found = answer()
        if key is not None:
            cache.write_answer(key, found)
    return found


def _compose(overrides: Sequence[str], config_dirs: Sequence[Path], root: str) -> Iterator[tuple[str, str | None]]:
    from omegaconf import OmegaConf
    from omegaconf.errors import OmegaConfBaseException

    from runner.base.dotted_keys import dotted, leaves
    from runner.config.compose.composer import Composer

    config = Composer(config_dirs, root).load(overrides)
    ours: Any = OmegaConf.to_container(config, resolve=False)
    del ours["hydra"]
    for key, value in ((dotted(place), value) for place, value in leaves(ours)):
        try:
            yield key, _typed(OmegaConf.select(config, key) if "${" in str(value) else value)
        except OmegaConfBaseException:  # it refers to a key that does not exist yet
            yield key, None


def _typed(value: Any) -> str | None:
    """Return a value as written in an override."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(value) if isinstance(value, int | float | str) else None


def cache_key(question: Sequence[str], config_dirs: Sequence[Path]) -> str | None:
    """Return a digest of a question and of everything that its answer depends on; None if that is too many files.

    The digest covers the working folder, the user's settings and the folders of the installed packages. It also covers
    path, time and size of every file in the built-in configs, robots and source and in the user's config folders.
    """
    packages = [(place, os.stat(place).st_mtime_ns) for place in sys.path if os.path.isdir(place)]  # noqa: PTH112, PTH116
    digest = hashlib.sha256(repr((sys.version, os.getcwd(), user_overrides(), question, packages)).encode())  # noqa: PTH109
    roots = (conf_dir(), robots_dir(), package_dir(), *(folder.resolve() for folder in config_dirs))
    states = state_of(roots, _MOST)
    digest.update(repr(states).encode())
    return None if states is None else digest.hexdigest()
