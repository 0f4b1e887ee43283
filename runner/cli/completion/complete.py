"""Completion by argcomplete: candidates for the word under the cursor, from the parsers of the commands.

The shell function that `runner -sc install=bash` prints calls `runner` with the typed line in COMP_LINE. A TAB imports
no plug-in and runs no code of a config folder.
"""

import argparse
import contextlib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TextIO

from argcomplete.completers import BaseCompleter
from argcomplete.finders import CompletionFinder
from argcomplete.lexers import split_line
from argcomplete.shell_integration import shellcode

from runner.base.errors import RunnerError, nearest
from runner.cli import commands
from runner.cli.arguments import NameList, Parser, StoredFolder
from runner.cli.completion.overrides import Typed, metric_names, override_words
from runner.cli.parser import build_parser
from runner.store.kinds import KINDS, WORD, Kind

_MOST = 1000  # words
_FEW = 50  # stored folders
_SHELLS = ("bash", "zsh", "fish")
_FILES = ("DIR", "FILE", "URDF", "PATH")


def complete(output: TextIO | None = None, leave: Callable[[int], object] = os._exit) -> None:
    """Print the words that complete the line in COMP_LINE, and nothing else; then leave the process.

    Args:
        output: Stream for the words; None for the file descriptor that the shell function reads.
        leave: Function that leaves the process with an exit code.
    """
    with contextlib.suppress(Exception):
        *_, words, _ = split_line(os.environ["COMP_LINE"], int(os.environ["COMP_POINT"]))
        name = next(_without_plugins(words[int(os.environ["_ARGCOMPLETE"]) :]), "")
        parser = build_parser([name]) if name in commands.names() else build_parser(["run"]).commands["run"]
        _Finder()(
            parser,
            always_complete_options=False,
            default_completer=_Values(),
            exit_method=leave,
            output_stream=output,
        )
    leave(0)


def shell_code(words: Sequence[str]) -> str:
    """Return the lines of a shell that turn on completion, for `-sc install=SHELL`.

    Raises:
        RunnerError: if the value is not `install=` and a known shell.
    """
    asked = [word.removeprefix("install=") for word in words if word.startswith("install=")]
    if len(asked) != 1 or asked[0] not in _SHELLS:
        wrong = ", ".join(word for word in words if "=" in word) or "nothing"
        near = nearest(asked[0], _SHELLS) if asked else ""
        raise RunnerError(
            f"-sc: found {wrong}{near}. Allowed: install= and one of {', '.join(_SHELLS)}, as in "
            'eval "$(runner -sc install=bash)"'
        )
    # The shell must not add a space after a key that ends with a dot.
    return shellcode(["runner"], shell=asked[0]).replace("[=/:]", "[=/:.]")


def _without_plugins(words: Iterable[str]) -> Iterator[str]:
    rest = iter(words)
    for word in rest:
        if word == "--plugin":
            next(rest, None)
        elif not word.startswith(("--plugin=", "-q")):
            yield word


class _Finder(CompletionFinder):
    """Argcomplete's finder, with a bounded number of words."""

    def _init_debug_stream(self) -> None:
        """Do not open file descriptor 9, which may belong to another part of the process."""

    def filter_completions(self, completions: list[str]) -> list[str]:
        """Return the distinct words, sorted; at most a thousand."""
        return sorted({*completions})[:_MOST]


class _Values(BaseCompleter):
    """Completer for the values of an argument, chosen by its type, metavar or name."""

    def __call__(
        self, *, prefix: str, action: argparse.Action, parser: argparse.ArgumentParser, parsed_args: argparse.Namespace
    ) -> Iterable[str]:
        """Return the words; none if an error occurs."""
        assert isinstance(parser, Parser)  # noqa: S101 - all parsers of the command line are
        with contextlib.suppress(Exception):
            return [*_values(prefix, action, parser, parsed_args)]
        return []


def _values(prefix: str, action: argparse.Action, parser: Parser, parsed_args: argparse.Namespace) -> Iterator[str]:
    if action.metavar == "OVERRIDE":
        given = vars(parsed_args)
        folders = [folder for folder in map(Path, given.get("config_dir") or []) if folder.is_dir()]
        typed = Typed(given.get("overrides") or [], folders, given.get("plugin") or [])
        yield from override_words(typed, prefix, parser.root)
        if parser.prog == "runner run" and not typed.overrides:
            yield from commands.names()
    elif action.metavar == "GROUP=MODULE":
        yield from _plugin_words(prefix)
    elif isinstance(action.type, StoredFolder):
        yield from _stored_folders(prefix, action.type.kinds)
    elif isinstance(action.type, NameList) and action.type.allowed:
        yield from _listed(prefix, action.type.allowed)
    else:
        for name, words in _NAMED.items():
            if action.dest.startswith(name):
                yield from _listed(prefix, words(parser))
    if hasattr(action, "completer"):  # argcomplete's name of an argument's words
        yield from _listed(prefix, action.completer(prefix=prefix, action=action))
    if hasattr(action, "completer") or (action.metavar in _FILES and not isinstance(action.type, StoredFolder)):
        yield from _files(prefix, folders_only=action.metavar not in ("FILE", "URDF", "PATH"))


def _listed(word: str, names: Iterable[str]) -> Iterator[str]:
    """Yield names that continue a typed comma-separated list."""
    head = word[: word.rfind(",") + 1]
    taken = {*head.split(",")}
    yield from (f"{head}{name}" for name in names if name not in taken)


def _topics(_: Parser) -> Iterable[str]:
    from runner.cli.list import TOPICS

    return TOPICS


def _families(_: Parser) -> Iterable[str]:
    from runner.sweeps.challenge.families import FAMILIES

    return FAMILIES


# By the prefix of the attribute that stores an argument.
_NAMED: Mapping[str, Callable[[Parser], Iterable[str]]] = {
    "topic": _topics,
    "metric": lambda _: metric_names(),
    "objectives": lambda _: metric_names(),
    "without": _families,
    "vary": lambda parser: (f"{name}=" for name in _families(parser)),
}


def _plugin_words(word: str) -> Iterator[str]:
    """Yield groups, and after a group the files of modules."""
    from runner.plugins.discovery import GROUPS  # takes as long as all the rest

    group, given, module = word.partition("=")
    if given:
        yield from (f"{group}={path}" for path in _files(module, suffix=".py"))
    else:
        yield from (f"{name}=" for name in GROUPS)


def _stored_folders(word: str, kinds: Sequence[Kind]) -> Iterator[str]:
    """Yield stored folders in ./outputs, or their parent folder if there are many, and the word `latest`."""
    yield WORD
    for kind in kinds:
        above = f"outputs/{KINDS[kind].folder}/"
        found = [entry.name for entry in _entries(above) if entry.is_dir() and not entry.name.startswith(".")]
        if len(found) <= _FEW or word.startswith(above):
            yield from (above + name for name in found)
        else:
            yield above
    if "/" in word:
        yield from _files(word, folders_only=True)


def _files(word: str, suffix: str = "", folders_only: bool = False) -> Iterator[str]:
    """Yield the paths that complete a typed path, with a suffix or only folders; folders end with a slash."""
    name = word.rpartition("/")[2]
    parent = word.removesuffix(name)
    for entry in _entries(parent or "."):
        if entry.name.startswith(".") and not name.startswith("."):
            continue
        if entry.is_dir():
            yield f"{parent}{entry.name}/"
        elif not folders_only and entry.name.endswith(suffix):
            yield f"{parent}{entry.name}"


def _entries(folder: str) -> Iterator[os.DirEntry[str]]:
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        yield from entries
