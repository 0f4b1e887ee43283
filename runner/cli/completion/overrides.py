"""Completion of overrides: group options from file names, keys from the config that Hydra composes."""

import re
from collections.abc import Iterator
from pathlib import PurePath

from runner.base.paths import conf_dir
from runner.cli.completion.line import Line
from runner.config.compose.options import group_options, groups

_SIGN = re.compile(r"[+~]*")
_FILE = re.compile(r"^  - (\w+)\s*(?:#.*)?$", re.MULTILINE)  # of a root's defaults: a file whose keys lie at the top
_GROUP = re.compile(r"^  - (\w+): ", re.MULTILINE)
_KEY = re.compile(r"^(\w+):[ \t]*([^\s#]?)", re.MULTILINE)
_SPEC = "spec.metrics."
_GLOBAL = "# @package _global_"  # begins a file whose keys lie at the top of the config


def override_words(line: Line, root: str) -> Iterator[str]:
    """Yield the overrides that may stand where the typed word does; Hydra is asked where a key below another is typed.

    Args:
        line: The line.
        root: Name of the file in conf/ that the config hangs on: "config" of a run, "calibrate" of a calibration.
    """
    word = _SIGN.sub("", line.word, count=1)
    sign = line.word.removesuffix(word)
    key, given, value = word.partition("=")
    if given and key in groups(line.config_dirs):
        found = _options(line, key, value)
    elif word.startswith(_SPEC) and not given and root == "config":
        found = _bounds(word.removeprefix(_SPEC))
    elif given or "." in word:
        from runner.cli.completion.keys import keys

        found = keys(line, word, root)
    else:
        found = _top(root)
    yield from (sign + each for each in found)


def _bounds(word: str) -> Iterator[str]:
    """Yield the metrics that a spec may bound, and behind one of them what a bound has."""
    from runner.cli.completion.arguments import metric_names

    metric, dot, _ = word.partition(".")
    if dot:
        yield from (f"{_SPEC}{metric}.{key}=" for key in ("min", "max", "reason"))
    else:
        yield from (f"{_SPEC}{name}." for name in metric_names())


def _options(line: Line, group: str, value: str) -> Iterator[str]:
    """Yield the options of a group; after a comma, those that do not stand there already."""
    known = {*group_options(group, line.config_dirs), *_plugins(line, group)}
    head = value[: value.rfind(",") + 1]
    yield from (f"{group}={head}{name}" for name in known - set(head.split(",")))


def _plugins(line: Line, group: str) -> Iterator[str]:
    """Yield the names of a group's parts that the line itself names by --plugin."""
    for plugin in line.plugins:
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
