"""Completion of a command's options, option values and positional arguments, from its own parser."""

import argparse
import importlib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from runner.cli.arguments import Parser, Stored, UsageError
from runner.cli.completion.basis import basis
from runner.cli.completion.line import Line
from runner.cli.completion.overrides import override_words
from runner.store.latest import WORD, Kind, folder_of
from runner.symbolic import cache

_NO_OPTION = "--?"  # which every parser refuses


def argument_words(line: Line, root: str) -> Iterator[str]:
    """Yield what may stand in the last place of a command's line.

    Args:
        line: The line; its first word is the command.
        root: Name of the file in conf/ that the command's config hangs on.
    """
    parser: argparse.ArgumentParser | None = parser_of(line.words[0])
    words = list(line.words[1:])
    while parser is not None:
        action, rest = _awaited(parser, words)
        if not isinstance(action, argparse._SubParsersAction) or not rest:
            yield from _words_of(line, parser, action, root)
            return
        parser, words = action.choices.get(rest[0]), list(rest[1:])


def parser_of(command: str) -> Parser | None:
    """Return the parser that a command makes; it gets an option that it does not have, and goes no further."""
    try:
        importlib.import_module(f"runner.cli.{command}").main([_NO_OPTION])
    except UsageError as error:
        return error.parser
    return None


def _awaited(parser: argparse.ArgumentParser, words: Sequence[str]) -> tuple[argparse.Action | None, Sequence[str]]:
    """Return the argument that comes next after some words; of an action such as `study new` with the words from it."""
    options, positionals = _options(parser), parser._get_positional_actions()
    place, rest = 0, list(words)
    while rest:
        word, *after = rest
        option = options.get(word)
        if option is not None and option.nargs != 0:
            if not after:
                return option, []
            after = after[1:]
        elif not word.startswith("-"):
            if place < len(positionals) and isinstance(positionals[place], argparse._SubParsersAction):
                return positionals[place], rest
            place += 1
        rest = after
    last = positionals[-1] if positionals and positionals[-1].nargs in ("*", "+") else None
    return (positionals[place] if place < len(positionals) else last), []


def _words_of(line: Line, parser: argparse.ArgumentParser, action: argparse.Action | None, root: str) -> Iterator[str]:
    options = _options(parser)
    option, given, _ = line.word.partition("=")
    if action is not None and action.option_strings:
        yield from _values(action, line, root)
    elif given and option in options:
        yield from _values(options[option], line, root, f"{option}=")
    elif line.word.startswith("-"):
        yield from options
    elif action is not None:
        yield from _values(action, line, root)


def _options(parser: argparse.ArgumentParser) -> dict[str, argparse.Action]:
    return parser._option_string_actions


def _values(action: argparse.Action, line: Line, root: str, before: str = "") -> Iterator[str]:
    """Yield the values of an argument: its choices, or what its type, its name or its place in the usage stands for."""
    word = line.word.removeprefix(before)
    names = next((names for dest, names in _NAMED.items() if action.dest.startswith(dest)), None)
    if action.choices is not None:
        yield from _listed(word, before, map(str, action.choices))
    elif isinstance(action.type, Stored):
        yield from (f"{before}{found}" for found in stored_folders(word, action.type.kinds))
    elif action.metavar == "OVERRIDE":
        yield from override_words(line, root)
    elif names is not None:
        yield from _listed(word, before, names(line.words[0]))
    if action.dest == "study" or (action.metavar in _FILES and not isinstance(action.type, Stored)):
        yield from files(line.word, before, folders_only=action.metavar not in ("FILE", "URDF"))


def _listed(word: str, before: str, names: Iterable[str]) -> Iterator[str]:
    """Yield names, those of a list with commas after what stands there already."""
    head = word[: word.rfind(",") + 1]
    taken = set(head.split(","))
    yield from (f"{before}{head}{name}" for name in names if name not in taken)


def _topics(_: str) -> Iterable[str]:
    from runner.cli.list import TOPICS

    return TOPICS


def _metrics(_: str) -> Iterable[str]:
    return metric_names()


def metric_names() -> Iterable[str]:
    """Return the names of our metrics, kept as long as the source is as it is: NumPy comes with their modules."""
    key = basis(["metrics"], [])
    known: list[str] | None = None if key is None else cache.read_answer(key)
    if known is None:
        from runner.cli.list import TOPICS

        known = [*TOPICS["metrics"]([])]
        if key is not None:
            cache.write_answer(key, known)
    return known


def _studies(command: str) -> Iterable[str]:
    from runner.study.names import study_names

    return (*study_names(), *(("audit", "all") if command == "reproduce" else ()))


_FILES = ("DIR", "FILE", "URDF")
# By how the attribute begins that an argument is kept in; each gets the command.
_NAMED: Mapping[str, Callable[[str], Iterable[str]]] = {
    "topic": _topics,
    "metric": _metrics,
    "objectives": _metrics,
    "study": _studies,
}


_FEW = 50


def stored_folders(word: str, kinds: Sequence[Kind]) -> Iterator[str]:
    """Yield the folders in ./outputs that hold some kinds of things, and the word `latest`.

    Of many, the folder that they lie in stands for them until it is typed.
    """
    yield WORD
    for kind in kinds:
        place = f"outputs/{folder_of(kind)}/"
        found = [name for name in _names(place) if not name.startswith(".")]
        if len(found) <= _FEW or word.startswith(place):
            yield from (place + name for name in found)
        else:
            yield place
    if "/" in word:
        yield from files(word, folders_only=True)


def files(word: str, before: str = "", suffix: str = "", folders_only: bool = False) -> Iterator[str]:
    """Yield the paths that complete one, folders with a slash at their end.

    Args:
        word: What is typed.
        before: What stands in it before the path, as `--config-dir=`.
        suffix: What a file's name must end with.
        folders_only: Whether to leave files out.
    """
    path = word.removeprefix(before)
    name = path.rpartition("/")[2]
    parent = path.removesuffix(name)
    for entry in _entries(parent or "."):
        if entry.name.startswith(".") and not name.startswith("."):
            continue
        if entry.is_dir():
            yield f"{before}{parent}{entry.name}/"
        elif not folders_only and entry.name.endswith(suffix):
            yield f"{before}{parent}{entry.name}"


def _entries(folder: str) -> Iterator[os.DirEntry[str]]:
    try:
        with os.scandir(folder) as entries:
            yield from entries
    except OSError:
        return


def _names(folder: str) -> list[str]:
    return [entry.name for entry in _entries(folder) if entry.is_dir()]
