"""Argument parser, argument types, and the options that mean the same in every command."""

import argparse
import math
import os
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from runner.base.errors import RunnerError, nearest, unknown
from runner.base.former_names import OPTIONS
from runner.store.kinds import Kind, find_folder


class StoredFolder:
    """Argument type: the folder of a stored result, or the word `latest`; see find_folder.

    Args:
        kinds: Kinds of stored results that the command accepts.
        other: Function that returns True for another path that the command accepts.
    """

    def __init__(self, *kinds: Kind, other: Callable[[Path], object] = lambda _: False) -> None:
        self.kinds, self._other = kinds, other

    def __call__(self, text: str) -> Path:
        """Return the path."""
        return Path(text) if self._other(Path(text)) else find_folder(text, self.kinds)


class NameList:
    """Argument type: a comma-separated list of names.

    Args:
        allowed: The names that the option takes; empty for any.
        most: Highest number of names.
    """

    def __init__(self, allowed: Sequence[str] = (), most: int | None = None) -> None:
        self.allowed, self.most = allowed, most

    def __call__(self, text: str) -> list[str]:
        """Return the names."""
        names = [name.strip() for name in text.split(",") if name.strip()]
        for name in names if self.allowed else ():
            if name not in self.allowed:
                raise argparse.ArgumentTypeError(unknown("name", name, self.allowed))
        if self.most is not None and len(names) > self.most:
            raise argparse.ArgumentTypeError(f"too many names ({text}). Allowed: at most {self.most}.")
        return names


def count(text: str) -> int:
    """Return an integer of 1 or more."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"not a count ('{text}'). Allowed: a whole number, 1 or more.")
    return int(text)


def seconds(text: str) -> float:
    """Return a time above 0 with its unit, such as 20ms, in s."""
    from runner.schema.units import read_quantity

    found = read_quantity(text)
    time = None if found is None else found.in_unit("s")
    if time is None or time <= 0.0:
        raise argparse.ArgumentTypeError(f"not a time ({text!r}). Allowed: a time above 0, such as 20ms.")
    return time


def read_per_cent(text: str) -> float | None:
    """Return the share of a string such as 10%; None for any other."""
    found = re.fullmatch(r"(\d{1,3}(?:\.\d{1,6})?)\s*%", text)
    return float(found[1]) / 100.0 if found else None


def config_folder(text: str) -> Path:
    """Return a config folder, which must exist."""
    if not Path(text).is_dir():
        raise RunnerError(f"--config-dir: no such folder ('{text}').")
    return Path(text)


_SHARED: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "output": (("-o", "--output"), {"type": Path, "metavar": "PATH"}),
    "metrics": (("--metrics",), {"type": NameList(), "metavar": "A,B"}),
    "jobs": (("-j", "--jobs"), {"type": count, "metavar": "N"}),
    "json": (("--json",), {"action": "store_true"}),
    "baseline": (("--baseline",), {"type": Path, "metavar": "FILE"}),
    "save_baseline": (("--save-baseline",), {"type": Path, "metavar": "FILE"}),
    "by": (("--by",), {"type": NameList(), "metavar": "A,B"}),
    "within": (("--within",), {"type": NameList(), "metavar": "A,B"}),
    "where": (("--where",), {"action": "append", "default": [], "metavar": "KEY=VALUE"}),
    "config_dir": (
        ("--config-dir", "-cd"),
        {"type": config_folder, "action": "append", "default": [], "metavar": "DIR"},
    ),
    "plugin": (("--plugin",), {"action": "append", "default": [], "metavar": "GROUP=MODULE"}),
    "quiet": (("-q", "--quiet"), {"action": "store_true"}),
}
_MEANINGS = {
    "config_dir": "your folder of YAML and URDFs; repeatable",
    "plugin": "your own controller, trajectory, plant, environment or metric, as controller=FILE.py; "
    "a controller can be one function: controller=FILE.py:NAME; repeat for more",
    "quiet": "print only the path of the result",
}


def put(content: str | bytes, output: Path | None) -> None:
    """Print a result, or write it to a file and print the path of the file."""
    content = content.encode("utf-8", errors="replace") if isinstance(content, str) else content
    if output is None:
        sys.stdout.write(content.decode())
    else:
        from runner.base.atomic import write_atomically

        write_atomically(output, content)
        print(output)


class UsageError(RunnerError):
    """Invalid arguments of a command."""


class Parser(argparse.ArgumentParser):
    """A parser without abbreviations; its errors are RunnerErrors.

    Attributes:
        commands: Parsers of the commands by name, if this is the parser of the whole line.
        root: File of conf/ that the overrides of the command change.
    """

    def __init__(self, parents: Sequence[argparse.ArgumentParser] = (), **options: Any) -> None:
        super().__init__(allow_abbrev=False, parents=parents, **options)
        self._inherited = {action for parent in parents for action in parent._actions}
        self.commands: dict[str, Parser] = {}
        self.root, self._options_first = "config", False

    def describe(self, text: str) -> None:
        """Set the description and the example of the help.

        Args:
            text: Docstring of the command's module; `Example: LINE` is its last paragraph.
        """
        self.description, _, example = text.rstrip().rpartition("\n\n")
        self.epilog = f"{example}\nOptions of every command: runner --help"

    def _get_formatter(self) -> argparse.HelpFormatter:
        # From Python 3.14 on the usage is coloured on a terminal, also within messages.
        plain: dict[str, Any] = {"color": False} if sys.version_info >= (3, 14) else {}
        return argparse.HelpFormatter(self.prog, max_help_position=28, **plain)

    def format_usage(self) -> str:
        """Return the usage, without the options of every command."""
        formatter = self._get_formatter()
        formatter.add_usage(self.usage, self._own(), ())
        return formatter.format_help()

    def format_help(self) -> str:
        """Return the help, without the options of every command."""
        formatter = self._get_formatter()
        formatter.add_text(self.description)
        formatter.start_section(argparse.SUPPRESS)
        formatter.add_arguments(self._own())
        formatter.end_section()
        return "\n".join(filter(None, (self.format_usage(), formatter.format_help(), self.epilog))).rstrip() + "\n"

    def _own(self) -> list[argparse.Action]:
        return [each for each in self._actions if each not in self._inherited and each.dest != "help"]

    def add_shared(self, *names: str, **meanings: str) -> None:
        """Add options that have the same meaning in every command.

        Args:
            names: Options with one meaning, such as "config_dir".
            meanings: Options with their help in this command, as output="where to write".
        """
        for name, meaning in ({name: _MEANINGS[name] for name in names} | meanings).items():
            flags, options = _SHARED[name]
            self.add_argument(*flags, help=meaning, **options)

    def add_formats(self, allowed: Sequence[str], meaning: str, most: int | None = None) -> None:
        """Add `--format A,B`.

        Args:
            allowed: Names of the formats.
            meaning: Help of the option.
            most: Highest number of formats; None for any number.
        """
        self.add_argument("--format", type=NameList(allowed, most), metavar="A,B", help=meaning)

    def add_overrides(self, meaning: str, root: str = "config") -> None:
        """Add a list of overrides, with options anywhere among them.

        Args:
            meaning: Help of the option.
            root: File of conf/ that they change.
        """
        self.add_argument("overrides", nargs="*", metavar="OVERRIDE", help=meaning)
        self.root, self._options_first = root, True

    def parse_known_args(self, args: Iterable[str] | None = None, namespace: Any = None) -> Any:
        """Parse arguments; options may be anywhere among overrides."""
        words = list(args or ())
        return super().parse_known_args(self._sorted(words) if self._options_first else words, namespace)

    def _sorted(self, words: Sequence[str]) -> list[str]:
        """Return the words with the options first; options without their value are last."""
        options: list[str] = []
        others: list[str] = []
        last: list[str] = []
        left = list(words)
        while left:
            word = left.pop(0)
            action = self._option_string_actions.get(word)
            if action is None or action.nargs == 0:
                (options if word.startswith("-") else others).append(word)
            elif left and (action.nargs != "?" or not (left[0].startswith("-") or "=" in left[0])):
                options += [word, left.pop(0)]
            else:
                last.append(word)
        return [*options, *others, *last]

    def _get_value(self, action: argparse.Action, arg_string: str) -> Any:
        """Return the value of an argument; completion takes any word, because an earlier word may be wrong."""
        return arg_string if "_ARGCOMPLETE" in os.environ else super()._get_value(action, arg_string)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Check that a value is one of an argument's choices; the message names the nearest."""
        choices = [str(choice) for choice in action.choices or ()]
        if choices and value not in choices:
            name = "/".join(action.option_strings) or str(action.metavar)
            raise RunnerError(unknown("name", value, choices, name))

    def _parse_optional(self, arg_string: str) -> Any:
        """Reject the former name of one of the command's options, before any value is read."""
        name = arg_string.partition("=")[0]
        if name not in self._option_string_actions:
            for present in OPTIONS.get(name, ()):
                if present.split()[0] in self._option_string_actions:
                    raise RunnerError(f"{name} is now called {present}.")
        return super()._parse_optional(arg_string)

    def reject(self, words: Sequence[str]) -> NoReturn:
        """Raise an error for arguments that the command does not take.

        Raises:
            UsageError: always, with the nearest option and the usage.
        """
        options = [name.removeprefix("--") for name in self._option_string_actions if name.startswith("--")]
        near = nearest(words[0].removeprefix("--"), options).replace("mean ", "mean --")
        self.error(f"unrecognized arguments: {' '.join(words)}{near}")

    def error(self, message: str) -> NoReturn:
        """Raise an error for invalid arguments.

        Raises:
            UsageError: always, with the usage.
        """
        text = message.removeprefix("argument ")
        usage = " ".join(self.format_usage().split()).replace("usage", "Usage", 1)
        raise UsageError(f"{text}{'' if text.endswith(('.', '?')) else '.'} {usage}")


WIDTHS = "single (88 mm), double (180 mm) or millimetres"
"""Meaning of `--width`, in every command."""

_COLUMNS = {"single": 88.0, "double": 180.0}  # mm
_NARROWEST, _WIDEST = 60.0, 400.0  # mm


def millimetres(text: str) -> float:
    """Return the width that `--width` names, in mm.

    Raises:
        RunnerError: If it is none, or outside the allowed range.
    """
    try:
        width = _COLUMNS.get(text) or float(text.removesuffix("mm"))
    except ValueError:
        width = math.nan
    if not _NARROWEST <= width <= _WIDEST:
        widths = f"single (88 mm), double (180 mm), or {_NARROWEST:g} to {_WIDEST:g} in mm"
        raise RunnerError(f"--width: not a width ('{text}'). Allowed: {widths}.")
    return width
