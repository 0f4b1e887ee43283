"""Print the JSON Schema of config files, for editors that complete keys.

Example: runner schema --output schema.json
"""

import json
from argparse import Namespace

from runner.cli.arguments import Parser, put


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "group", nargs="?", default="", metavar="GROUP", help="a group, such as controller (default: the whole config)"
    )
    parser.add_shared(output="file to write (default: standard output)")


def run(options: Namespace) -> int:
    """Print the schema, or write it and print its path."""
    from runner.config.json_schema import json_schema

    put(json.dumps(json_schema(options.group), indent=1) + "\n", options.output)
    return 0
