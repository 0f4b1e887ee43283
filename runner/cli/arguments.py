"""Command-line arguments of the commands: argparse, with our own way out."""

import argparse
from pathlib import Path
from typing import NoReturn

from runner.base.errors import RunnerError, nearest
from runner.store.latest import Kind, find_folder


class Stored:
    """The type of an argument that is the folder of something stored, or the word `latest`; see find_folder.

    Args:
        kinds: What it may be the folder of.
    """

    def __init__(self, kinds: tuple[Kind, ...]) -> None:
        self.kinds = kinds

    def __call__(self, text: str) -> Path:
        """Return the folder that a text names."""
        return find_folder(text, self.kinds)


def stored(*kinds: Kind) -> Stored:
    """Return the type of an argument that is the folder of something stored, of one of some kinds."""
    return Stored(kinds)


class UsageError(RunnerError):
    """Arguments that a command does not take.

    Attributes:
        parser: The command's parser.
    """

    def __init__(self, message: str, parser: "Parser") -> None:
        super().__init__(f"{message}; {' '.join(parser.format_usage().split())}")
        self.parser = parser


class Parser(argparse.ArgumentParser):
    """A parser whose errors leave as all others do.

    Args:
        command: Name of the command, such as "check".
        description: What it does, its module's docstring.
    """

    def __init__(self, command: str, description: str | None) -> None:
        super().__init__(prog=f"runner {command}", description=description, allow_abbrev=False)

    def _check_value(self, action: argparse.Action, value: object) -> None:
        """Refuse a value that is none of an argument's choices, with the nearest of these."""
        choices = [str(choice) for choice in action.choices or ()]
        if choices and value not in choices:
            name = "/".join(action.option_strings) or str(action.metavar)
            raise RunnerError(f"{name}: no '{value}'{nearest(str(value), choices)}; allowed: {', '.join(choices)}")

    def error(self, message: str) -> NoReturn:
        """Raise what is wrong with the arguments.

        Raises:
            UsageError: always, with the usage.
        """
        raise UsageError(message, self)


class ActionParser(Parser):
    """The parser of one action of a command, such as `work new`."""

    def __init__(self, prog: str, help: str = "", **_: object) -> None:
        super().__init__(prog.removeprefix("runner "), help)
