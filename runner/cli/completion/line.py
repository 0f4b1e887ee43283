"""Partly typed command line, split into complete words and the word under the cursor."""

import os
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePath
from typing import NamedTuple

_CONFIG_DIR = ("--config-dir", "-cd")
_PLUGIN = "--plugin"


class Line(NamedTuple):  # no dataclass, whose module takes a tenth of the time of a TAB
    """What is typed after the program's name.

    Attributes:
        words: The words before the one that is typed, without those of --plugin.
        word: The word that is typed, up to the cursor; may be empty.
        plugins: What stands after each --plugin, as in "controller=mine/spring.py".
        naming_plugin: Whether the typed word, or what follows `--plugin=` in it, names a plug-in.
    """

    words: Sequence[str]
    word: str
    plugins: Sequence[str] = ()
    naming_plugin: bool = False

    @property
    def config_dirs(self) -> list[Path]:
        """The config folders that it names; those that exist."""
        named = [word.partition("=")[2] for word in self.words if word.startswith("--config-dir=")]
        named += [after for before, after in zip(self.words, self.words[1:], strict=False) if before in _CONFIG_DIR]
        return [folder for folder in map(Path, named) if folder.is_dir()]


def read_line(environment: Mapping[str, str]) -> Line:
    """Return the line that a shell hands over in COMP_LINE, up to the cursor in COMP_POINT (bytes) where it says so."""
    text = environment["COMP_LINE"]
    point = environment.get("COMP_POINT", "")
    if point.isdecimal():
        text = os.fsdecode(os.fsencode(text)[: int(point)])
    before, word = _split(text)
    return _without_plugins(before[_program(before) :], word)


def _split(text: str) -> tuple[list[str], str]:
    """Return the whole words of a line, and the one that is typed, which ends where the line does."""
    cut = max(text.rfind(" "), text.rfind("\t")) + 1
    try:
        return shlex.split(text[:cut]), text[cut:]
    except ValueError:  # a quote that is still open
        return text[:cut].split(), text[cut:]


def _program(words: Sequence[str]) -> int:
    """Return how many words name the program: `runner`, `python -m runner` or `python FILE`."""
    if not (words and PurePath(words[0]).name.startswith("python")):
        return 1
    return 3 if words[1:2] == ["-m"] else 2


def _without_plugins(words: Sequence[str], word: str) -> Line:
    others: list[str] = []
    plugins: list[str] = []
    rest = iter(words)
    for each in rest:
        if each == _PLUGIN:
            plugin = next(rest, None)
            if plugin is None:
                return Line(others, word, plugins, naming_plugin=True)
            plugins.append(plugin)
        elif each.startswith(f"{_PLUGIN}="):
            plugins.append(each.removeprefix(f"{_PLUGIN}="))
        else:
            others.append(each)
    return Line(others, word, plugins, naming_plugin=word.startswith(f"{_PLUGIN}="))
