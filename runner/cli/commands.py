"""The commands: their groups, the tree of their parsers, and the help that follows from both."""

import importlib
import textwrap
from collections.abc import Iterable
from pathlib import Path

from runner.cli.arguments import Parser
from runner.config.compose.options import groups

GROUPS = {
    "Run experiments": ("run", "sweep", "status", "tune", "calibrate"),
    "Look at results": ("report", "table", "figures", "sensitivity"),
    "Compare and check": ("compare", "check", "verify"),
    "Reproduce papers": ("reproduce", "study", "audit", "benchmark"),
    "Robots and controllers": ("list", "doctor", "example"),
}
"""Names of the commands, by what a person wants to do."""
COMMANDS = tuple(name for names in GROUPS.values() for name in names)
OVERRIDES = ("run", "sweep")
"""Commands whose line is overrides and flags of Hydra; `run` is the command of a line that names none."""

COMMON = Parser(prog="runner", add_help=False)
"""Options that every command has."""
COMMON.add_shared("plugin", "quiet")

GUIDE = """\
runner: simulate and compare robot-arm controllers from the command line

  runner robot=macro trajectory=quintic          one run: key metrics and the run's folder
  runner report latest                           a report on it, HTML and PDF
  runner sweep robot=macro controller.period=5ms,10ms
                                                 a sweep over every combination
  runner list                                    available robots, controllers, trajectories, metrics and studies
  runner doctor FILE                             check if your own URDF or MJCF fits

All commands: runner --help. All keys of a run: runner --cfg job. The pages are in docs/ of the source, docs/tutorial.md
first.
"""
_NOTES = """\
`runner COMMAND --help` describes one command. A line of overrides without a command is a run; with -m it is a sweep.
`latest` means the newest result, instead of a DIR. `runner --cfg job` shows all keys of a run.
eval "$(runner -sc install=bash)" turns on completion in bash; zsh and fish also work.
"""
_EXITS = """\
Exit codes: 0 success, 1 a run failed or a check failed, 2 invalid input, 3 internal error, 130 interrupted, 143
terminated.
"""
_COLUMN, _WIDTH = 13, 120


def build_parser(names: Iterable[str] = COMMANDS) -> Parser:
    """Return the parser of the command line; only the modules of the commands named are imported."""
    root = Parser(prog="runner", parents=[COMMON], usage="runner [COMMAND] ...")
    actions = root.add_subparsers(dest="command", metavar="COMMAND", prog="runner")
    for name in names:
        module = importlib.import_module(f"runner.cli.{_module(name)}")
        root.commands[name] = parser = actions.add_parser(name, description=module.__doc__, parents=[COMMON])
        module.add_arguments(parser)
        parser.set_defaults(run=module.run, parser=parser)
    return root


def help_text() -> str:
    """Return the help on all commands."""
    lines = [GUIDE.splitlines()[0]]
    for group, names in GROUPS.items():
        lines += ["", group]
        modules: dict[str, list[str]] = {}
        for name in names:
            modules.setdefault(_summary(name), []).append(name)
        for summary, same in modules.items():
            first = f"  {', '.join(same):<{_COLUMN}}"
            lines.append(textwrap.fill(summary, _WIDTH, initial_indent=first, subsequent_indent=" " * len(first)))
    shared = COMMON.format_help().partition("options:\n")[2]
    groups_text = textwrap.fill(f"Groups of config: {', '.join(groups())}.", _WIDTH)
    return "\n".join([*lines, "", "Options of every command", shared, _NOTES, groups_text, _EXITS])


def _module(name: str) -> str:
    return "overrides" if name in OVERRIDES else name


def _summary(name: str) -> str:
    """Return the first sentence of a command's description without its usage; reading it is faster than an import."""
    description = Path(__file__).with_name(f"{_module(name)}.py").read_text().split('"""')[1]
    return " ".join(description.partition("\n\n")[0].partition("`: ")[2].split())
