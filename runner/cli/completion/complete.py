"""Completion of the last word of a partly typed command line."""

import re
from collections.abc import Iterator

from runner.cli.completion.arguments import argument_words, files
from runner.cli.completion.line import Line
from runner.cli.completion.overrides import override_words
from runner.cli.help import COMMANDS, HELP, SPELLED_OUT

_ROOTS = {"calibrate": "calibrate"}  # commands whose config hangs on another file of conf/ than that of a run
_FLAG = re.compile(r"^  runner (--?[\w-]+)(?: ([a-z]+)(?= ))?", re.MULTILINE)  # in HELP, as `--cfg job`


def complete(line: Line) -> Iterator[str]:
    """Yield the words that complete a line; each begins with what is typed."""
    for word in _words(line):
        if word.startswith(line.word):
            yield word


def _words(line: Line) -> Iterator[str]:
    if line.naming_plugin:
        yield from _plugin_words(line.word)
    elif line.words and line.words[0] in COMMANDS:
        yield from argument_words(line, _ROOTS.get(line.words[0], "config"))
    else:
        yield from _run_words(line)


def _run_words(line: Line) -> Iterator[str]:
    """Yield what a run or a sweep takes, and the commands where nothing stands before."""
    flags = dict(_FLAG.findall(HELP))
    before = line.words[-1] if line.words else ""
    if not line.words:
        yield from (*COMMANDS, *SPELLED_OUT, "--help", "--version")
    if flags.get(before):
        yield flags[before]
    elif before == "--config-dir":
        yield from files(line.word, folders_only=True)
    elif line.word.startswith("--config-dir="):
        yield from files(line.word, "--config-dir=", folders_only=True)
    elif line.word.startswith("-"):
        yield from flags
    else:
        yield from override_words(line, "config")


def _plugin_words(word: str) -> Iterator[str]:
    """Yield groups, and the files of modules after them."""
    from runner.plugins.discovery import GROUPS  # takes as long as all the rest

    flag = "--plugin=" if word.startswith("--plugin=") else ""
    group, given, _ = word.removeprefix(flag).partition("=")
    if given:
        yield from files(word, f"{flag}{group}=", suffix=".py")
    else:
        yield from (f"{flag}{name}=" for name in GROUPS)
