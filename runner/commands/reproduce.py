"""`runner reproduce [NAME] [OVERRIDES]`: run what is missing for a published work, and write its report.

OVERRIDES say how the runs are made: hydra.sweeper.workers and .address, sweep.time_limit, .attempts, .retry and
.on_failure, limits.cpu_hours and .memory; caveats.RULE.KEY, what is told of them. What is simulated is the work's own.
"""

import json
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from runner.commands.arguments import Parser
from runner.config.compose import quiet_environment
from runner.errors import RunnerError, nearest
from runner.works.changes import FILE
from runner.works.names import work_names

if TYPE_CHECKING:
    from runner.reporting.document import Document
    from runner.reporting.expected_caveats import ExpectedCaveat
    from runner.store import Calibration, Run

AUDIT = "audit"
_FREE = ("hydra.sweeper.", "sweep.", "limits.", "caveats.")


@dataclass(frozen=True)
class _Way:
    """How a work is made: folder of runs and reports, overrides of the engine, and the command as typed."""

    outputs: Path
    overrides: Sequence[str]
    command: str


@dataclass(frozen=True)
class _Reproduced:
    """What came of a work: its report, the runs behind it by name, why others are missing, and caveats it expects."""

    document: "Document"
    runs: "Mapping[str, Run]"
    missing: Mapping[str, str]
    expected: "Sequence[ExpectedCaveat]" = ()
    calibrations: "Mapping[str, Calibration]" = field(default_factory=dict)


def main(arguments: Sequence[str]) -> int:
    """Reproduce one work or all; print the report's folder as the last line."""
    works = (*work_names(), AUDIT)
    parser = Parser("reproduce", __doc__)
    parser.add_argument("work", nargs="?", default="all", metavar="NAME", help=f"{', '.join(works)} or all")
    parser.add_argument("overrides", nargs="*", metavar="OVERRIDE", help="such as hydra.sweeper.workers=1")
    parser.add_argument("--outputs", type=Path, default=Path("outputs"), help="folder of runs and reports")
    parser.add_argument("--check", action="store_true", help="exit 1 where a finding fell or a caveat is unexpected")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write verdicts, findings, caveats, numbers")
    options = parser.parse_intermixed_args(arguments)
    if options.work not in (*works, "all"):
        raise RunnerError(
            f"no work '{options.work}'{nearest(options.work, (*works, 'all'))}; works: {', '.join(works)}, all"
        )
    others = [text for text in options.overrides if not text.startswith(_FREE) or text.startswith("sweep.trace")]
    if others:
        raise RunnerError(f"reproduce: {others[0]}: what is simulated is the work's own; free are {', '.join(_FREE)}")
    quiet_environment()
    way = _Way(options.outputs, options.overrides, shlex.join(["runner", "reproduce", *arguments]))
    made = {}
    for work in _shortest_first(works) if options.work == "all" else (options.work,):
        made[work] = _reproduce(work, way)
    if options.json is not None:
        _write_conclusions(made, options.json)
    fallen = _tell_fallen(made) if options.check else False
    return 1 if fallen or any(each.missing for each in made.values()) else 0


def _shortest_first(works: Sequence[str]) -> list[str]:
    """Return works in the order of the number of their runs, so that there is something to read soon."""
    from runner.works.work import load_work

    return sorted(works, key=lambda name: 0 if name == AUDIT else len(load_work(name).jobs()))


def _reproduce(work: str, way: _Way) -> _Reproduced:
    from runner import store
    from runner.reporting.render import write_report

    folder = way.outputs / "reports" / work
    store.prepare(way.outputs)
    made = (_audit if work == AUDIT else _reproduce_work)(work, way, folder)
    print("writing the report ...", file=sys.stderr)
    write_report(made.document, folder)
    _write_conclusions({work: made}, folder / FILE)
    for name, why in made.missing.items():
        print(f"runner: {work}: {name} is missing in the report: {why}", file=sys.stderr)
    print(folder)
    return made


def _tell_fallen(made: Mapping[str, _Reproduced]) -> bool:
    """Print the findings that no longer hold and the caveats that are not expected; return whether there are any."""
    from runner.reporting.conclusions import fallen
    from runner.reporting.expected_caveats import unexpected_caveats

    lines = [
        f"{work}: {line}"
        for work, each in made.items()
        for line in (*fallen(each.document), *unexpected_caveats(each.runs, each.expected))
    ]
    for line in lines:
        print(f"runner: {line}", file=sys.stderr)
    return bool(lines)


def _write_conclusions(made: Mapping[str, _Reproduced], path: Path) -> None:
    from runner.reporting.conclusions import conclusions
    from runner.store.atomic import write_atomically

    content = {
        work: conclusions(each.document, each.runs, each.calibrations, each.expected) for work, each in made.items()
    }
    write_atomically(path, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())


def _reproduce_work(name: str, way: _Way, folder: Path) -> _Reproduced:
    """Make what a work needs, and its document."""
    from runner.works.making import make_all
    from runner.works.work import load_work

    work = load_work(name)
    work.measure(way.outputs)
    runs, calibrations = make_all(work.jobs(), work.calibrations(), way.outputs, way.overrides, way.command)
    missing = runs.missing | calibrations.missing
    return _Reproduced(work.document(runs, calibrations), runs, missing, work.expected, calibrations)


def _audit(work: str, way: _Way, folder: Path) -> _Reproduced:
    from runner.audit.audit import as_csv, audit_all
    from runner.reporting.audit.report import audit_document
    from runner.store.atomic import write_atomically

    print("auditing the equations ...", file=sys.stderr)
    judged = audit_all()
    table = as_csv([each for source in judged.values() for each in source])
    write_atomically(folder / "equations.csv", table.encode())
    return _Reproduced(audit_document(judged), {}, {})
