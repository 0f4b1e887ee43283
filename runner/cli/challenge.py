"""Ask the question of a comparison again with one choice changed at a time, and say for which choices it holds.

The question is that of a sweep (its levels), of two sweeps or runs, or of a tuning. The asked case comes first, on
fresh seeds. The variations of `conf/challenge` follow: numerical choices, equivalent choices, conditions, and the gain
of only one side. The same command continues an interrupted challenge.

Example: runner challenge latest --vary "duration=0.7,3" --without payload
"""

import shlex
from argparse import Namespace

from runner.base.errors import RunnerError
from runner.base.sanitize import one_line
from runner.cli.arguments import NameList, Parser, StoredFolder
from runner.sweeps.challenge.budget import ChallengeBudget, read_budget

_JOBS = 2


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "folders",
        nargs="+",
        type=StoredFolder("run", "sweep", "tuning"),
        metavar="RESULT",
        help="a sweep, a tuning, two sweeps or two runs; or latest",
    )
    parser.add_shared(
        by="one sweep: axis whose values are compared (default: its question)",
        metrics="metric that is compared (default: the first one of the result)",
        where="only cells with this value of a key; repeat for more",
        jobs=f"number of processes (default: {_JOBS})",
    )
    parser.add_argument(
        "--vary", action="append", default=[], metavar="KEY=A,B", help="values of a family or key; repeat for more"
    )
    parser.add_argument("--without", type=NameList(), default=[], metavar="A,B", help="families to leave out")
    parser.add_argument(
        "--budget", type=read_budget, default=ChallengeBudget(), metavar="60s|N", help="time, or number of variations"
    )


def run(options: Namespace) -> int:
    """Simulate what is missing, print the sentences and the table; print the folder as the last line."""
    from runner.reporting.challenge.question import read_question
    from runner.reporting.challenge.words import NOT_DONE, scope_sentences, variations_table
    from runner.reporting.table import terminal
    from runner.store.kinds import outputs_of
    from runner.sweeps.challenge.run import challenge
    from runner.sweeps.challenge.table import change_values, read_values
    from runner.sweeps.run import Engine

    for option in ("by", "metrics"):
        given = getattr(options, option) or ()
        if len(given) > 1:
            raise RunnerError(f"--{option}: several names ({','.join(given)}). Allowed: one.")
    question = read_question(
        options.folders, next(iter(options.by or ()), ""), next(iter(options.metrics or ()), ""), options.where
    )
    values = change_values(read_values(question.config_dirs), options.vary, options.without)
    command = shlex.join(["runner", "challenge", *options.words])
    engine = Engine(options.jobs or _JOBS, None)
    made = challenge(question, values, outputs_of(options.folders[0]), engine, command, options.budget)
    for text in scope_sentences(made):
        print(one_line(text))
    if made.came_back:
        print(f"\n{terminal(variations_table(made), indent='')}\n\n{NOT_DONE}")
    print(made.folder)
    return 0
