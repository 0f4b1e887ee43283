"""`runner reproduce [NAME]`: run what is missing for a published work, and write its report."""

import multiprocessing
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from runner.commands.arguments import Parser
from runner.config.compose import quiet_environment
from runner.errors import RunnerError, nearest

if TYPE_CHECKING:
    from runner.reporting.job import Job
    from runner.store import Calibration, Run

_PROCESSES = 2


def main(arguments: Sequence[str]) -> int:
    """Reproduce one work or all; print the report's folder as the last line."""
    parser = Parser("reproduce", __doc__)
    parser.add_argument("work", nargs="?", default="all", metavar="NAME", help=f"{', '.join(WORKS)} or all")
    parser.add_argument("--outputs", type=Path, default=Path("outputs"), help="folder of runs and reports")
    options = parser.parse_args(arguments)
    if options.work not in (*WORKS, "all"):
        raise RunnerError(
            f"no work '{options.work}'{nearest(options.work, (*WORKS, 'all'))}; works: {', '.join(WORKS)}, all"
        )
    quiet_environment()
    return max(_reproduce(work, options.outputs) for work in (WORKS if options.work == "all" else (options.work,)))


def _reproduce(work: str, outputs: Path) -> int:
    from runner import store

    folder = outputs / "reports" / work
    store.prepare(outputs)
    _WORKS[work](work, outputs, folder)
    print(folder)
    return 0


def _reproduce_runs(work: str, outputs: Path, folder: Path) -> None:
    """Reproduce a work by its package in reporting: `plan` says which jobs to run, `report` what to write of them."""
    from runner.reporting.render import write_report

    plan = import_module(f"runner.reporting.{work}.plan").plan
    document = getattr(import_module(f"runner.reporting.{work}.report"), f"{work}_document")
    runs = run_all(plan(), outputs)
    print("writing the report ...", file=sys.stderr)
    write_report(document(runs), folder)


def _reproduce_thesis(work: str, outputs: Path, folder: Path) -> None:
    from runner.reporting.thesis.dynamics_benchmark import FILE, measure

    measure(outputs / FILE)
    _reproduce_runs(work, outputs, folder)


def _reproduce_meca500(work: str, outputs: Path, folder: Path) -> None:
    from runner.reporting.meca500.calibration_plan import calibration_jobs
    from runner.reporting.meca500.plan import plan
    from runner.reporting.meca500.report import meca500_document
    from runner.reporting.render import write_report

    runs = run_all(plan(), outputs)
    calibrations = calibrate_all(calibration_jobs(), outputs)
    print("writing the report ...", file=sys.stderr)
    write_report(meca500_document(runs, calibrations), folder)


def _audit(work: str, outputs: Path, folder: Path) -> None:
    from runner.audit.audit import as_csv, audit_all
    from runner.reporting.audit.report import audit_document
    from runner.reporting.render import write_report

    print("auditing the equations ...", file=sys.stderr)
    judged = audit_all()
    print("writing the report ...", file=sys.stderr)
    write_report(audit_document(judged), folder)
    folder.joinpath("equations.csv").write_text(
        as_csv([each for source in judged.values() for each in source]), encoding="utf-8"
    )


_WORKS = {
    "thesis": _reproduce_thesis,
    "xarm7": _reproduce_runs,
    "meca500": _reproduce_meca500,
    "audit": _audit,
}
WORKS = tuple(_WORKS)


def run_all(jobs: Mapping[str, "Job"], outputs: Path) -> dict[str, "Run"]:
    """Run what is not stored yet on two processes, with progress on standard error; return all runs by name."""
    from runner import store

    ticks = {name: job.ticks for name, job in jobs.items()}
    folders = _make_all(_run_job, {name: job.overrides for name, job in jobs.items()}, ticks, "tick", outputs)
    commands = {name: shlex.join(["runner", *job.overrides]) for name, job in jobs.items()}
    return {name: store.open_run(folders[name]).made_by(commands[name]) for name in jobs}


def calibrate_all(jobs: Mapping[str, tuple[str, ...]], outputs: Path) -> dict[str, "Calibration"]:
    """Carry out the calibrations that are not stored yet, likewise; return all by name."""
    from runner import store

    folders = _make_all(_calibrate_job, jobs, dict.fromkeys(jobs, 1), "calibration", outputs)
    return {name: store.open_calibration(folders[name]) for name in jobs}


def _make_all(
    make: Callable[[tuple[str, ...], str], str],
    jobs: Mapping[str, tuple[str, ...]],
    costs: Mapping[str, int],
    unit: str,
    outputs: Path,
) -> dict[str, Path]:
    """Call a function with the overrides of each job, and return the folders that it makes, by name.

    Args:
        make: The function; in a worker process.
        jobs: Overrides by name.
        costs: What each job costs, roughly, for the estimate of what is left.
        unit: What the costs count.
        outputs: Folder of runs and calibrations.
    """
    from tqdm import tqdm

    context = multiprocessing.get_context("spawn")  # a forked PyBullet or thread pool is not safe
    folders: dict[str, Path] = {}
    with ProcessPoolExecutor(_PROCESSES, mp_context=context) as pool:
        futures = {pool.submit(make, overrides, str(outputs)): name for name, overrides in jobs.items()}
        progress = tqdm(total=sum(costs.values()), unit=unit, unit_scale=True, desc="running")
        try:
            with progress:
                for future in as_completed(futures):
                    name = futures[future]
                    folders[name] = Path(future.result())
                    progress.update(costs[name])
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return folders


def _run_job(overrides: tuple[str, ...], outputs: str) -> str:
    """Run one job in a worker process."""
    quiet_environment()
    from runner.execution import run

    return str(run(*overrides, f"outputs={outputs}").folder)


def _calibrate_job(overrides: tuple[str, ...], outputs: str) -> str:
    """Carry out one calibration in a worker process."""
    quiet_environment()
    from runner.calibration_job import calibrate

    return str(calibrate(*overrides, f"outputs={outputs}").folder)
