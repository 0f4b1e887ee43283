"""`runner [run] OVERRIDES`, `runner sweep OVERRIDES`: simulate one run, or every combination of the listed values.

An override sets a key or chooses from a group, as controller.period=5ms or robot=macro. `runner sweep` is the same as
`runner -m`. All other flags are Hydra's.
"""

import shlex
from argparse import Namespace
from collections.abc import Sequence

from runner.base.errors import RunnerError
from runner.cli.arguments import Parser

_MANY = ("-m", "--multirun")


def add_arguments(parser: Parser) -> None:
    """Add the arguments, for help and completion; `simulate` takes the words as they are typed."""
    parser.add_overrides("such as robot=macro; a sweep takes lists, as seed=0,1")
    parser.add_argument(*_MANY, action="store_true", help="simulate a sweep over every combination")
    _add_own(parser)
    parser.add_argument("-c", "--cfg", choices=("job", "hydra", "all"), help="show the config without a simulation")
    parser.add_argument("--hydra-help", action="store_true", help="show all flags of Hydra")
    parser.add_argument("--version", action="store_true", help="show the version")


def _add_own(parser: Parser) -> None:
    parser.add_shared("config_dir", output="outputs folder, as outputs=PATH", jobs="number of processes of a sweep")


def run(arguments: Namespace) -> int:
    """Simulate the run or the sweep of a parsed line."""
    return simulate(arguments.words)


def simulate(words: Sequence[str]) -> int:
    """Simulate the run or the sweep of a line; print the folder as the last line."""
    own = Parser(prog="runner run", add_help=False)
    _add_own(own)
    given, others = own.parse_known_args(words)
    typed = shlex.join(["runner", *words])
    if given.output is not None:
        others.append(f"outputs={given.output}")
    if given.jobs is not None:
        if not any(word in _MANY for word in others):
            raise RunnerError("--jobs: one run uses one process. Add -m for a sweep.")
        others.append(f"hydra.sweeper.workers={given.jobs}")
    from runner.cli.run import main

    return main(others, given.config_dir, typed)
