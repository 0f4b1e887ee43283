"""Completion of overrides: group options from file names, keys from the config that Hydra composes."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePath
from typing import NamedTuple

from runner.base.paths import conf_dir
from runner.config.compose.options import group_options, groups

_SIGN = re.compile(r"[+~]*")
_FILE = re.compile(r"^  - (\w+)\s*(?:#.*)?$", re.MULTILINE)  # of a root's defaults: a file whose keys lie at the top
_GROUP = re.compile(r"^  - (\w+): ", re.MULTILINE)
_KEY = re.compile(r"^(\w+):[ \t]*([^\s#]?)", re.MULTILINE)
_SPEC = "spec.metrics."
_GLOBAL = "# @package _global_"  # begins a file whose keys lie at the top of the config


class Typed(NamedTuple):  # a dataclass would take a tenth of the time of a TAB
    """Words of a command that are typed before the word under the cursor.

    Attributes:
        overrides: The overrides.
        config_dirs: The user's config folders that exist.
        plugins: The plug-ins, as in "controller=mine/spring.py".
    """

    overrides: Sequence[str]
    config_dirs: Sequence[Path]
    plugins: Sequence[str]


def override_words(typed: Typed, typed_word: str, root: str) -> Iterator[str]:
    """Yield the overrides that complete a word; Hydra composes the config if the word has a key with a dot.

    Args:
        typed: The words before it.
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
        from runner.cli.completion.keys import keys

        found = keys(typed.overrides, typed.config_dirs, word, root)
    else:
        found = _top(root)
    yield from (sign + each for each in found)


def _bounds(word: str) -> Iterator[str]:
    """Yield the metrics that a spec may bound, and the keys of a bound behind a metric."""
    from runner.cli.completion.keys import metric_names

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
            yield PurePath(module).stem if module.endswith(".py") else module.rpartition(".")[2]


def _top(root: str) -> Iterator[str]:
    """Yield groups, and the keys at the top of a config: `key=`, or `key.` where more lie below it."""
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
