"""Hydra's own parser of flags, on every supported Python."""

import argparse
from types import FunctionType, SimpleNamespace
from typing import Any

from hydra._internal import utils


class _TextHelp(argparse.ArgumentParser):
    """A parser whose help texts are strings.

    Hydra 1.3 passes an object as the help of a flag. From Python 3.14 on argparse checks each help when it is added,
    and rejects this one.
    """

    def add_argument(self, *names: Any, **options: Any) -> argparse.Action:
        """Add an argument; see argparse."""
        return super().add_argument(*names, **{**options, "help": str(options["help"])})


def hydra_parser() -> argparse.ArgumentParser:
    """Return the parser that Hydra's command makes of its flags."""
    names = {**vars(utils), "argparse": SimpleNamespace(ArgumentParser=_TextHelp)}
    parser: argparse.ArgumentParser = FunctionType(utils.get_args_parser.__code__, names)()
    return parser
