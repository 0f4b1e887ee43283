"""Run the benchmarks; the missed rows are listed at the end, and exit code 1 means that there are some."""

import argparse
import io
import sys
from collections.abc import Iterable
from contextlib import redirect_stdout
from importlib import import_module
from typing import TextIO

from runner.base.engines import has_pybullet, quiet_environment

NAMES = (
    "tick",
    "laws",
    "mujoco_tick",
    "derivatives",
    "caveats",
    "around",
    "repetitions",
    "cold_start",
    "reproduce",
    "sweep",
    "identification",
)
_AGAINST_PYBULLET = ("tick", "laws", "cold_start")  # they time its calls, or take an arm of its package


class Printed(io.StringIO):
    """Standard output that also keeps what is printed.

    Args:
        shown: The stream that shows it.
    """

    def __init__(self, shown: TextIO) -> None:
        super().__init__()
        self._shown = shown

    def write(self, text: str) -> int:
        """Print and keep a string."""
        self._shown.write(text)
        self._shown.flush()
        return super().write(text)


def missed_rows(printed: str) -> list[str]:
    """Return the printed rows whose target is missed."""
    return [" ".join(line.split()) for line in printed.splitlines() if "MISSED" in line]


def run(names: Iterable[str], rounds: int | None) -> int:
    """Run benchmarks; print the missed rows, and return the exit code."""
    missed = []
    for name in names:
        if name in _AGAINST_PYBULLET and not has_pybullet():
            print(f"{name}: left out because PyBullet is not installed")
            continue
        with redirect_stdout(Printed(sys.stdout)) as printed:
            good = import_module(f"bench.{name}").main(rounds)
        rows = missed_rows(printed.getvalue())
        missed += [f"{name}: {row}" for row in rows or ([] if good else ["MISSED"])]
    print("\n".join(["", f"{len(missed)} missed", *missed]) if missed else "\nall targets are met")
    return 1 if missed else 0


def main() -> int:
    """Run the benchmarks of the command line; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"benchmarks: {', '.join(NAMES)} (default: all)")
    parser.add_argument(
        "--rounds", type=int, metavar="N", help="rounds of each; 1 is brief, with less work (default: each its own)"
    )
    options = parser.parse_args()
    unknown = sorted({*options.names} - {*NAMES})
    if unknown:
        parser.error(f"NAME: unknown benchmark ({', '.join(unknown)}). Allowed: {', '.join(NAMES)}.")
    if options.rounds is not None and options.rounds < 1:
        parser.error(f"--rounds: too few ({options.rounds}). Allowed: 1 or more.")
    quiet_environment()
    return run(options.names or NAMES, options.rounds)


if __name__ == "__main__":
    sys.exit(main())
