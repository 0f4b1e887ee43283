"""`runner work diff OLD NEW`: what changed between two makings of published works.

OLD and NEW are files that `runner reproduce --json` wrote, or folders of the works' reports.
"""

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from runner.commands.arguments import Parser
from runner.texts import one_line
from runner.works.changes import KINDS, Change, Value, changes, read_conclusions

_TOLD = 20  # changes of a kind that are printed without --all


def main(arguments: Sequence[str]) -> int:
    """Print what moved, a line each, those that matter most first."""
    parser = Parser("work", __doc__)
    parser.add_argument("action", choices=("diff",), help="what to do")
    parser.add_argument("old", type=Path, metavar="OLD", help="file or folder of the earlier making")
    parser.add_argument("new", type=Path, metavar="NEW", help="file or folder of the later one")
    parser.add_argument("--all", action="store_true", help=f"print all changes, not {_TOLD} of a kind")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write them to a file, too")
    options = parser.parse_args(arguments)
    found = changes(read_conclusions(options.old), read_conclusions(options.new))
    counts = Counter(change.kind for change in found)
    for kind in KINDS:
        of_kind = [change for change in found if change.kind == kind]
        shown = of_kind if options.all else of_kind[:_TOLD]
        for change in shown:
            print(one_line(_told(change)))
        if len(shown) < len(of_kind):
            print(f"{kind}: {len(of_kind) - len(shown)} more; --all prints them")
    print("; ".join(f"{kind}: {counts[kind]} changed" for kind in KINDS if counts[kind]) or "nothing changed")
    if options.json is not None:
        from runner.store.atomic import write_atomically

        text = json.dumps([asdict(change) for change in found], indent=1, ensure_ascii=False)
        write_atomically(options.json, f"{text}\n".encode())
    return 0


def _told(change: Change) -> str:
    moved = f" ({100.0 * change.size:.3g} %)" if change.size < float("inf") else ""
    return f"{change.kind}: {change.name}: {_value(change.old)} -> {_value(change.new)}{moved}"


def _value(value: Value) -> str:
    if value is None:
        return "none"
    return f"{value:.6g}" if isinstance(value, float) else value
