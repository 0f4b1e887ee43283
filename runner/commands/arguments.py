"""Command-line arguments of the commands: argparse, with our own way out."""

import argparse
from typing import NoReturn

from runner.errors import RunnerError


class Parser(argparse.ArgumentParser):
    """A parser whose errors leave as all others do.

    Args:
        command: Name of the command, such as "check".
        description: What it does, its module's docstring.
    """

    def __init__(self, command: str, description: str | None) -> None:
        super().__init__(prog=f"runner {command}", description=description, allow_abbrev=False)

    def error(self, message: str) -> NoReturn:
        """Raise what is wrong with the arguments.

        Raises:
            RunnerError: always, with the usage.
        """
        raise RunnerError(f"{message}; {' '.join(self.format_usage().split())}")
