"""Parser of the command line."""

from collections.abc import Iterable

from runner.cli import commands
from runner.cli.arguments import Parser

COMMON = Parser(prog="runner", add_help=False)
"""Options that every command has."""
COMMON.add_shared("plugin", "quiet")


def build_parser(names: Iterable[str] = commands.names()) -> Parser:
    """Return the parser of the command line; only the modules of the commands named are imported."""
    root = Parser(prog="runner", parents=[COMMON], usage="runner [COMMAND] ...")
    actions = root.add_subparsers(dest="command", metavar="COMMAND", prog="runner")
    for name in names:
        module = commands.load(name)
        root.commands[name] = parser = actions.add_parser(name, parents=[COMMON])
        parser.describe(str(module.__doc__))
        module.add_arguments(parser)
        parser.set_defaults(run=module.run, parser=parser)
    return root
