"""Argument parser and argument types shared by the commands."""

import argparse
from pathlib import Path
from typing import Any, NoReturn

from runner.base.errors import RunnerError, nearest
from runner.base.former_names import OPTIONS
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


def stored_folder(*kinds: Kind) -> Stored:
    """Return the type of an argument that is the folder of something stored, of one of some kinds."""
    return Stored(kinds)


def name_list(text: str) -> list[str]:
    """Return the names of a list with commas."""
    return [name.strip() for name in text.split(",") if name.strip()]


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
        """Reject a value, or one of a list, that is not among an argument's choices, and name the nearest of these."""
        choices = [str(choice) for choice in action.choices or ()]
        for one in value if isinstance(value, list) else [value]:
            if choices and one not in choices:
                name = "/".join(action.option_strings) or str(action.metavar)
                raise RunnerError(f"{name}: no '{one}'{nearest(str(one), choices)}; allowed: {', '.join(choices)}")

    def _parse_optional(self, arg_string: str) -> Any:
        """Reject the former name of one of the command's options, before any value is read."""
        name = arg_string.partition("=")[0]
        if OPTIONS.get(name) in self._option_string_actions and name not in self._option_string_actions:
            raise RunnerError(f"{name} is now called {OPTIONS[name]}.")
        return super()._parse_optional(arg_string)

    def error(self, message: str) -> NoReturn:
        """Raise what is wrong with the arguments.

        Raises:
            UsageError: always, with the usage.
        """
        raise UsageError(message, self)


class ActionParser(Parser):
    """The parser of one action of a command, such as `study new`."""

    def __init__(self, prog: str, help: str = "", **_: object) -> None:
        super().__init__(prog.removeprefix("runner "), help)
