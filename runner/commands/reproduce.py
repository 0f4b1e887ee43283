"""`runner reproduce [NAME] [OVERRIDES]`: run what is missing for a published work, and write its report.

OVERRIDES say how the runs are made: hydra.sweeper.workers and .address, sweep.time_limit, .attempts, .retry and
.on_failure, limits.cpu_hours and .memory; caveats.RULE.KEY, what is told of them. What is simulated is the work's own.
"""

import json
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from runner.commands.arguments import Parser
from runner.config.compose import quiet_environment
from runner.errors import RunnerError, nearest

if TYPE_CHECKING:
    from runner.reporting.document import Document
    from runner.reporting.expected_caveats import ExpectedCaveat
    from runner.reporting.job import Job, Made
    from runner.store import Calibration, Run

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


def main(arguments: Sequence[str]) -> int:
    """Reproduce one work or all; print the report's folder as the last line."""
    parser = Parser("reproduce", __doc__)
    parser.add_argument("work", nargs="?", default="all", metavar="NAME", help=f"{', '.join(WORKS)} or all")
    parser.add_argument("overrides", nargs="*", metavar="OVERRIDE", help="such as hydra.sweeper.workers=1")
    parser.add_argument("--outputs", type=Path, default=Path("outputs"), help="folder of runs and reports")
    parser.add_argument("--check", action="store_true", help="exit 1 where a finding fell or a caveat is unexpected")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write verdicts, findings, caveats, numbers")
    options = parser.parse_intermixed_args(arguments)
    if options.work not in (*WORKS, "all"):
        raise RunnerError(
            f"no work '{options.work}'{nearest(options.work, (*WORKS, 'all'))}; works: {', '.join(WORKS)}, all"
        )
    others = [text for text in options.overrides if not text.startswith(_FREE) or text.startswith("sweep.trace")]
    if others:
        raise RunnerError(f"reproduce: {others[0]}: what is simulated is the work's own; free are {', '.join(_FREE)}")
    quiet_environment()
    way = _Way(options.outputs, options.overrides, shlex.join(["runner", "reproduce", *arguments]))
    made = {}
    for work in WORKS if options.work == "all" else (options.work,):
        made[work] = _reproduce(work, way)
    if options.json is not None:
        _write_conclusions(made, options.json)
    fallen = _tell_fallen(made) if options.check else False
    return 1 if fallen or any(each.missing for each in made.values()) else 0


def _reproduce(work: str, way: _Way) -> _Reproduced:
    from runner import store
    from runner.reporting.render import write_report

    folder = way.outputs / "reports" / work
    store.prepare(way.outputs)
    made = _WORKS[work](work, way, folder)
    print("writing the report ...", file=sys.stderr)
    write_report(made.document, folder)
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

    content = {work: conclusions(each.document, each.runs, each.expected) for work, each in made.items()}
    write_atomically(path, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())


def _reproduce_runs(work: str, way: _Way, folder: Path) -> _Reproduced:
    """Reproduce a work by its package in reporting: `plan` says which jobs to run, `report` what to write of them."""
    plan = import_module(f"runner.reporting.{work}.plan").plan
    document = getattr(import_module(f"runner.reporting.{work}.report"), f"{work}_document")
    runs, _ = make_all(plan(), {}, way.outputs, way.overrides, way.command)
    expected = import_module(f"runner.reporting.{work}.caveats").EXPECTED
    return _Reproduced(document(runs), runs, runs.missing, expected)


def _reproduce_thesis(work: str, way: _Way, folder: Path) -> _Reproduced:
    from runner.reporting.thesis.dynamics_benchmark import FILE, measure

    measure(way.outputs / FILE)
    return _reproduce_runs(work, way, folder)


def _reproduce_meca500(work: str, way: _Way, folder: Path) -> _Reproduced:
    from runner.reporting.meca500.calibration_plan import calibration_jobs
    from runner.reporting.meca500.caveats import EXPECTED
    from runner.reporting.meca500.plan import plan
    from runner.reporting.meca500.report import meca500_document

    runs, calibrations = make_all(plan(), calibration_jobs(), way.outputs, way.overrides, way.command)
    missing = runs.missing | calibrations.missing
    return _Reproduced(meca500_document(runs, calibrations), runs, missing, EXPECTED)


def _audit(work: str, way: _Way, folder: Path) -> _Reproduced:
    from runner.audit.audit import as_csv, audit_all
    from runner.reporting.audit.report import audit_document
    from runner.store.atomic import write_atomically

    print("auditing the equations ...", file=sys.stderr)
    judged = audit_all()
    table = as_csv([each for source in judged.values() for each in source])
    write_atomically(folder / "equations.csv", table.encode())
    return _Reproduced(audit_document(judged), {}, {})


_WORKS = {
    "thesis": _reproduce_thesis,
    "xarm7": _reproduce_runs,
    "meca500": _reproduce_meca500,
    "audit": _audit,
}
WORKS = tuple(_WORKS)


def make_all(
    jobs: Mapping[str, "Job"],
    calibrations: Mapping[str, tuple[str, ...]],
    outputs: Path,
    overrides: Sequence[str] = (),
    command: str = "runner reproduce",
) -> "tuple[Made[Run], Made[Calibration]]":
    """Make the runs and calibrations of a work that are not stored yet; return all by name.

    Args:
        jobs: The runs by name.
        calibrations: Overrides of the calibrations by name.
        outputs: Folder in which they are stored.
        overrides: How they are made: keys of hydra.sweeper, sweep and limits.
        command: The command that makes them and goes on with it.

    Raises:
        ConfigError: if one cannot be made, or all would cost too much; nothing has been started then.
        StoreError: if the disk does not take them.
        RunnerError: if another sweep is at work in the same folder, or the Dask scheduler does not answer.
    """
    from runner import store
    from runner.calibration_job import CALIBRATION
    from runner.reporting.job import Made
    from runner.sweeps.listed import Item, Listed
    from runner.sweeps.loading import Loader
    from runner.sweeps.run import Engine, run_sweep

    items = {name: Item(job.overrides) for name, job in jobs.items()}
    items |= {name: Item(own, CALIBRATION) for name, own in calibrations.items()}
    shared = [text for text in overrides if not text.startswith("hydra.")]
    loader = Loader()
    sweeper = loader.sweeper([text for text in overrides if text.startswith("hydra.")])
    plan = Listed(items, [*shared, "sweep.trace=all", f"outputs={outputs}"], loader)
    ended = run_sweep(plan, Engine(sweeper.workers, sweeper.address), command, accept_cut_short=False)
    places = dict(zip(items, ended.names, strict=True))
    ends = {name: ended.ends.get(place) for name, place in places.items()}
    missing = {name: "not begun" for name, end in ends.items() if end is None}
    missing |= {name: end.failure for name, end in ends.items() if end is not None and end.cut_short}
    commands = {name: shlex.join(["runner", *job.overrides]) for name, job in jobs.items()}
    runs = {
        name: store.open_run(outputs / "runs" / places[name]).made_by(commands[name])
        for name in jobs
        if name not in missing
    }
    found = {
        name: store.open_calibration(outputs / "calibrations" / places[name])
        for name in calibrations
        if name not in missing
    }
    return (
        Made(runs, {name: why for name, why in missing.items() if name in jobs}),
        Made(found, {name: why for name, why in missing.items() if name in calibrations}),
    )
