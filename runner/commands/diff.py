"""`runner diff A B`: the former name of `runner compare`, kept for one release."""

import sys
from collections.abc import Sequence

from runner.commands import compare


def main(arguments: Sequence[str]) -> int:
    """Do what `runner compare` does, and say that it is called so."""
    print(
        "runner: `runner diff` is now called `runner compare`; the old name goes with the next release", file=sys.stderr
    )
    return compare.main(arguments)
