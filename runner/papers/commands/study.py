"""Write, check and compare studies.

`check` simulates the missing runs and checks every expression, every condition both ways, literal numbers in findings
and unexpected caveats. `diff` compares two versions: files that `runner reproduce --json` printed, or folders of
reports.

Example: runner study new mine
"""

import json
import shlex
import sys
from argparse import Namespace
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.paths import studies_with
from runner.base.sanitize import one_line
from runner.cli.arguments import Parser
from runner.config.compose.files import outputs_dir
from runner.papers.study.changes import KINDS, ROUNDED, Value, VersionChange, changes, read_conclusions

if TYPE_CHECKING:
    from runner.papers.reporting.published_claims import PublishedClaim

_TOLD = 20  # changes of a kind that are printed without --all


def add_arguments(parser: Parser) -> None:
    """Add the actions."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    new = actions.add_parser("new", help="write a first study into a folder")
    new.add_argument("folder", type=Path, metavar="DIR", help="a new folder, or an empty one")
    check = actions.add_parser("check", help="check a study")
    study = check.add_argument("study", metavar="DIR", help="the study's folder, or the name of an installed one")
    study.completer = _names  # type: ignore[attr-defined]
    check.add_shared(output="outputs folder (default: outputs)")
    check.set_defaults(output=outputs_dir())
    check.add_argument("--code", action="store_true", help="run the Python of DIR")
    diff = actions.add_parser("diff", help="print the changes between two versions")
    diff.add_argument("old", type=Path, metavar="OLD", help="file or folder of the earlier version")
    diff.add_argument("new", type=Path, metavar="NEW", help="file or folder of the later one")
    diff.add_argument("--all", action="store_true", help=f"print all changes, not {_TOLD} of a kind")
    diff.add_shared(json="print all changes as JSON")


def _names(**_: object) -> Sequence[str]:
    """Return the names of the studies, which complete the word of the line."""
    from runner.papers.study.names import study_names

    return study_names()


def run(options: Namespace) -> int:
    """Carry out one action."""
    return {"new": _new, "check": _check, "diff": _diff}[options.action](options)


def _new(options: Namespace) -> int:
    from runner.papers.study.names import write_new

    for path in write_new(options.folder):
        print(path)
    print(f"runner: `runner reproduce {shlex.quote(str(options.folder))}` makes its report", file=sys.stderr)
    return 0


def _check(options: Namespace) -> int:
    """Print the problems of a study, one per line; return 1 if there are any."""
    from runner.papers.study.names import find_study

    find_study(options.study)  # rejects an unknown name before anything is read
    from runner.papers.study.chapters import Chapters
    from runner.papers.study.check import problems
    from runner.papers.study.execute import make_all
    from runner.papers.study.study import load_study

    study = load_study(options.study, options.code)
    found = [*problems(Chapters(study, *make_all(study, options.output)))]
    for line in found:
        print(one_line(line))
    print("nothing is wrong" if not found else f"{len(found)} problem{'s' if len(found) > 1 else ''}")
    return 1 if found else 0


def _diff(options: Namespace) -> int:
    """Print the changes, one per line, the most important first."""
    found = changes(read_conclusions(options.old), read_conclusions(options.new))
    if options.json:
        print(json.dumps([asdict(change) for change in found], indent=1, ensure_ascii=False))
        return 0
    counts = Counter(change.kind for change in found)
    for kind in KINDS:
        of_kind = [change for change in found if change.kind == kind]
        shown = of_kind if options.all else [] if kind == ROUNDED else of_kind[:_TOLD]
        for change in shown:
            print(one_line(_told(change)))
        if 0 < len(shown) < len(of_kind):
            print(f"{kind}: {len(of_kind) - len(shown)} more; --all prints them")
    rounded = counts.pop(ROUNDED, 0)
    parts = [f"{kind}: {counts[kind]} changed" for kind in KINDS if counts[kind]] or ["nothing changed"]
    parts += [f"{rounded} number{'s' if rounded > 1 else ''} equal up to rounding"] if rounded else []
    print("; ".join(parts))
    return 0


def _told(change: VersionChange) -> str:
    moved = f" ({100.0 * change.size:.3g} %)" if change.size < float("inf") else ""
    return f"{change.kind}: {change.name}: {_value(change.old)} -> {_value(change.new)}{moved}"


def _value(value: Value) -> str:
    if value is None:
        return "none"
    return f"{value:.6g}" if isinstance(value, float) else value


def _list_claims(_: Sequence[Path]) -> dict[str, str]:
    from runner.papers.reporting.published_claims import CLAIMS, STATEMENTS, load_claims, load_statements

    claims = {
        f"{source} {claim.number}": f"{claim.statement}{_printed(claim)} ({claim.place})"
        for source in studies_with(CLAIMS)
        for claim in load_claims(source)
    }
    statements = {
        f"{source} {number}": f"{each.statement} ({each.place})"
        for source in studies_with(STATEMENTS)
        for number, each in enumerate(load_statements(source), start=1)
    }
    return claims | statements


def _printed(claim: "PublishedClaim") -> str:
    """Return a claim's value as printed; an empty string if the source gives no number."""
    return f": {' to '.join(f'{value:g}' for value in claim.printed)} {claim.unit}" if claim.printed else ""


def _list_studies(_: Sequence[Path]) -> dict[str, str]:
    from runner.papers.study.manifest import read_manifest
    from runner.papers.study.names import find_study, study_names

    found = {name: read_manifest(find_study(name).folder) for name in study_names()}
    apart = {
        name: "" if manifest.in_all else " (not made by `runner reproduce all`)" for name, manifest in found.items()
    }
    return {name: f"{manifest.title}. {manifest.source}{apart[name]}" for name, manifest in found.items()}


TOPICS = {"claims": _list_claims, "studies": _list_studies}
"""Topics that this adds to `runner list`."""
