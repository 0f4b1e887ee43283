"""Execution of a whole sweep, from its plan to its stored runs."""

import contextlib
import math
import os
import shutil
import sys
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from runner import store
from runner.assembly.dependent_keys import depends, idle_keys
from runner.assembly.run_cost import check_cpu_time, check_memory_together
from runner.assembly.validation import validate
from runner.base import progress
from runner.base.atomic import refuse_links, remove_leftovers
from runner.base.errors import ConfigError, StoreError, TemporaryError
from runner.base.sanitize import one_line
from runner.config.compose.composer import Composer
from runner.config.compose.given_keys import given_keys
from runner.config.composed import CALIBRATION
from runner.config.limits import SweepConfig
from runner.plugins.discovery import has_users_parts, in_use
from runner.store.finished import FINER
from runner.store.kinds import note
from runner.store.names import Names
from runner.sweeps.at_work import at_work, commands_at_work, commands_in
from runner.sweeps.check import Checked, check
from runner.sweeps.differing import Resolved
from runner.sweeps.engine import in_process, on_cluster
from runner.sweeps.estimate import START_UP, Estimate, Pace, estimate
from runner.sweeps.outcomes import Ends
from runner.sweeps.part import GridPart, own_part, share_sweep
from runner.sweeps.plan import Plan
from runner.sweeps.processes import local_processes, on_processes
from runner.sweeps.queue import Queue
from runner.sweeps.remote import GO_ON, check_address, remote_workers
from runner.sweeps.typed import plan_typed
from runner.sweeps.work import ChunkResult, find_calibrated
from runner.sweeps.writer import Rules, TraceKeeping, one_in

_DAMAGE_SHOWN = 10
_LOOKED_AT = 100  # cells
_SCRATCH = "scratch-"  # start of the names of folders for temporary files of a command
_ALL_TRACES_UP_TO = 3000  # runs; with more, sweep.trace=auto is sample


def _tell(text: str) -> None:
    print(f"runner: {text}", file=sys.stderr)


@dataclass(frozen=True)
class Engine:
    """Location of the execution of a sweep: processes on this machine, or a Dask cluster.

    Attributes:
        workers: Number of worker processes on this machine; 0 for the current process.
        address: Address of a running Dask scheduler, such as tcp://127.0.0.1:8786, or its scheduler file; then
            `workers` has no effect.
    """

    workers: int
    address: str | None

    def __post_init__(self) -> None:
        if isinstance(self.workers, bool) or not isinstance(self.workers, int) or self.workers < 0:
            raise ConfigError(f"hydra.sweeper.workers: must be a whole number, 0 or more; found {self.workers!r}")
        if self.address is not None:
            check_address(self.address)


@dataclass(frozen=True)
class Ended:
    """Result of a sweep.

    Attributes:
        folder: The sweep's folder.
        outputs: The outputs folder.
        names: Hash of each cell's run or calibration.
        ends: Outcomes of the finished runs and calibrations, by hash.
        failures: Overrides, reason and details file of each failed cell.
        left: Number of runs that are missing because the sweep stopped at the first failure.
        stored: Number of cached runs.
        resolved: Values that differ between the configs of the runs.
        part: Part of the sweep that the other attributes but the folder describe, as K/N; empty for the whole.
    """

    folder: Path
    outputs: Path
    names: Names
    ends: Ends
    failures: Sequence[tuple[Sequence[str], str, Path]]
    left: int
    stored: int = field(compare=False)
    resolved: Resolved = field(compare=False)
    part: str = ""


def sweep_typed(arguments: Sequence[str], of_sweeper: Sequence[str], source: Composer, command: str) -> Ended:
    """Execute the missing runs of a command line.

    Args:
        arguments: Overrides as typed, without those of Hydra itself.
        of_sweeper: Overrides of hydra.sweeper: workers, address and params.
        source: Composer of the configs.
        command: The command line, stored with the sweep.
    """
    plan, sweeper = plan_typed(arguments, source, of_sweeper)
    if len(plan) == 1:
        text = "nothing is swept, and a single run is made: no key has several values, as seed=0,1 has"
        print(f"runner: {text}", file=sys.stderr)
    ended = run_sweep(plan, Engine(sweeper.workers, sweeper.address), command)
    for line in find_idle_keys(plan):
        print(one_line(f"runner: warning: {line}"), file=sys.stderr)
    return ended


def find_idle_keys(plan: Plan) -> list[str]:
    """Return a line for each key without effect in the cells of a plan; at most 100 are evaluated."""
    first = plan.composed(0)
    if first.root == CALIBRATION or not any(map(depends, given_keys(first))):
        return []
    cells = range(0, len(plan), -(-len(plan) // _LOOKED_AT))
    counts = Counter(line for cell in cells for line in idle_keys(validate(plan.composed(cell))))
    of = f"{len(cells)} cells" if len(cells) == len(plan) else f"{len(cells)} evaluated cells"
    return [line if count == len(cells) else f"{line} ({count} of {of})" for line, count in counts.items()]


def run_sweep(plan: Plan, engine: Engine, command: str, accept_cut_short: bool = True) -> Ended:
    """Execute the missing runs and calibrations of a plan, the longest first.

    Args:
        plan: The plan.
        engine: Location of the execution.
        command: The command of the sweep, stored with it.
        accept_cut_short: True if a stored run that was aborted counts as done; False if it counts as an error.

    Raises:
        ConfigError: if a cell cannot be run, or the sweep exceeds a limit; no run has been started.
        StoreError: if the sweep cannot be written.
        RunnerError: if the Dask scheduler does not answer.
        TemporaryError: if a run cannot be written, or a worker fails; finished runs are stored.
    """
    plan = own_part(plan)
    checked = check(plan)
    names, outputs = checked.names, checked.outputs
    progress.begin("looking for stored runs")
    store.prepare(outputs)
    folder = share_sweep(plan, checked, command) if isinstance(plan, GridPart) else write_sweep(plan, checked, command)
    with at_work(folder) as name:
        note(folder)
        rules = make_rules(checked.first.sweep, folder, len(plan.whole), name)
        rules = replace(rules, accept_cut_short=accept_cut_short)
        ends, stored = make_missing(plan, checked, rules, engine)
    failed = [(cell, ends[names[cell]]) for cell in ends.failed.tolist()]
    failures = [(plan.overrides(cell), end.failure, rules.details(end.name)) for cell, end in failed]
    part = plan.name if isinstance(plan, GridPart) else ""
    return Ended(folder, outputs, names, ends, failures, len(ends.left), stored, checked.resolved, part)


def make_missing(
    plan: Plan, checked: Checked, rules: Rules, engine: Engine, tell: Callable[[str], None] = _tell
) -> tuple[Ends, int]:
    """Execute the missing runs and calibrations of a checked plan; return the outcomes and the number of cached ones.

    Args:
        plan: The plan.
        checked: Result of its check.
        rules: The rules.
        engine: Location of the execution.
        tell: Function that prints the number of runs and the expected duration.

    Raises:
        ConfigError: if the jobs exceed a limit of CPU time or memory.
        TemporaryError: if a result cannot be written, or a worker fails.
    """
    names = checked.names
    ends = find_stored(checked, rules)
    stored = len(ends)
    left = ends.left[np.argsort(-checked.costs[ends.left], kind="stable")]
    queue = Queue(plan.alike, names, checked.costs, left, rules)
    try:
        for report in make_jobs(plan, checked, queue, left, engine, stored, tell):
            ends.add(report.outcomes)
            if report.trouble:
                raise TemporaryError(f"{report.trouble}; {GO_ON}")
            if rules.stop_at_failure and any(end.failure for end in report.outcomes):
                break
    except KeyboardInterrupt:  # no worker is left to finish its run
        clean(rules, names)
        raise
    clean(rules, names)
    return ends, stored


def write_sweep(plan: Plan, checked: Checked, command: str) -> Path:
    """Store the overrides and the hash of each run; return the sweep's folder."""
    axes = plan.axes()
    if axes is not None:
        return store.write_grid(checked.outputs, axes, checked.names, command, checked.first.spec.metrics)
    runs = [(plan.overrides(i), name) for i, name in enumerate(checked.names) if i not in checked.calibrations]
    return store.write_sweep(checked.outputs, runs, command, checked.first.spec.metrics)


def make_rules(settings: SweepConfig, folder: Path, runs: int, command: str) -> Rules:
    """Return the rules for a number of runs of a sweep in a folder; `command` is the name of at_work."""
    automatic: TraceKeeping = "all" if runs <= _ALL_TRACES_UP_TO else "sample"
    refuse_links(folder.parent.parent, folder / "logs")
    folder = folder.resolve()
    return Rules(
        plugins=in_use(),
        outputs=folder.parent.parent,
        sweep=folder,
        trace=automatic if settings.trace == "auto" else settings.trace,
        settings=settings,
        accept_cut_short=settings.retry == "none",
        one_in=one_in(runs),
        command=command,
    )


def find_stored(checked: Checked, rules: Rules) -> Ends:
    """Return the outcomes of the jobs that count as done; a run that must keep its trace counts only with its trace."""
    finished = store.Finished(rules.outputs)
    ends = Ends(checked.names)
    in_shards = finished.places(checked.names)
    ends.add_stored(finished, in_shards[_counts(finished, in_shards, rules)])
    found = [_find_calibrated(rules, checked.names[cell], finished.damage) for cell in sorted(checked.calibrations)]
    found += [finished.in_folder(name) for name in finished.folders(checked.names)]
    for end in found:
        if end is not None and rules.accepts(end):
            known = ends.get(end.name)
            if known is None or end.rank <= known.rank:
                ends.add([end])
    for damage in finished.damage[:_DAMAGE_SHOWN]:
        _tell(f"{damage}; making it again")
    if len(finished.damage) > _DAMAGE_SHOWN:
        _tell(f"and {len(finished.damage) - _DAMAGE_SHOWN} more; `runner verify {rules.outputs}` names them all")
    return ends


def _counts(finished: store.Finished, places: NDArray[np.intp], rules: Rules) -> NDArray[np.bool_]:
    """Return True for each run in a shard that counts as done; a run that must keep its trace does not count."""
    rank = finished.rank[places]
    accepted = np.array([rules.accepts_rank(each) for each in range(3)])[rank]
    pairs = zip(Names(finished.names[places]), rank.tolist(), strict=True)
    traceless = [each == 2 or not rules.keeps_trace(name, each > 0) for name, each in pairs]
    counts: NDArray[np.bool_] = accepted & np.array(traceless, dtype=bool)
    return counts


def _find_calibrated(rules: Rules, name: str, damage: list[str]) -> store.RunOutcome | None:
    try:
        return find_calibrated(rules.outputs, name)
    except store.DamagedError as error:
        damage.append(str(error))
        return None


def make_jobs(
    plan: Plan,
    checked: Checked,
    queue: Queue,
    cells: NDArray[np.intp],
    engine: Engine,
    stored: int,
    tell: Callable[[str], None] = _tell,
) -> Iterator[ChunkResult]:
    """Execute the jobs of a queue and show the progress; yield the report of each chunk.

    Args:
        plan: The plan.
        checked: Result of the check of the plan.
        queue: The queue.
        cells: Cells of the queue, shape (n,). A tuning, whose trials are chosen later, gives a similar cell for each.
        engine: Location of the execution.
        stored: Number of cached jobs.
        tell: Function that prints the number of jobs and the expected duration.

    Raises:
        ConfigError: if the jobs exceed a limit of CPU time or memory.
        TemporaryError: if the time for a job cannot be written.
    """
    tell(_count(checked, len(cells), stored))
    if not len(cells):
        return
    check_memory_together(checked.memory, 1 if engine.address else min(max(engine.workers, 1), len(cells)))
    ticks = int(checked.costs[cells].sum())
    progress.begin("estimating")
    expected = estimate(plan, checked, cells, queue.rules.kept)
    check_cpu_time(checked.first.limits, expected.seconds, len(cells), expected.known)
    pace = Pace(queue.rules.sweep)
    with _workers(queue, len(cells), engine, expected, tell) as reports:
        progress.begin("simulating", ticks, "ticks", lambda: queue.ticks_made)
        for report in reports:
            try:
                pace.add(len(report.outcomes))
            except StoreError as error:
                raise TemporaryError(f"{error}; {GO_ON}") from None
            yield report
    progress.begin("summing up")


def _count(checked: Checked, left: int, stored: int) -> str:
    runs = "run" if left + stored == 1 else "runs"
    kind = "runs and calibrations" if checked.calibrations else runs
    return f"{left + stored} {kind}, {stored} of them stored already" if stored else f"{left} {kind}"


@contextlib.contextmanager
def _workers(
    queue: Queue, jobs: int, engine: Engine, expected: Estimate, tell: Callable[[str], None]
) -> Iterator[Iterator[ChunkResult]]:
    """Start the workers of a queue, given its expected CPU time; yield an iterator over the reports of its chunks."""
    if engine.address is not None:
        with (
            remote_workers(engine.address) as remote,
            contextlib.closing(on_cluster(queue, remote)) as reports,
        ):
            processes = max(1, len(remote.usable()))
            tell(expected.in_words(processes, processes))
            yield reports
    elif seconds := _seconds_in_process(queue.rules, min(engine.workers, jobs), expected):
        tell(duration_text(queue.rules, jobs, engine, expected))
        with contextlib.closing(_begun_in_process(queue, engine.workers, seconds)) as reports:
            yield reports
    else:
        tell(duration_text(queue.rules, jobs, engine, expected))
        workers = min(engine.workers, jobs)
        with (
            local_processes(workers, _scratch(queue.rules)) as local,
            contextlib.closing(on_processes(queue, local)) as reports,
        ):
            yield reports


def duration_text(rules: Rules, jobs: int, engine: Engine, expected: Estimate) -> str:
    """Return the expected duration of jobs on this machine in words; one process has all jobs of a short sweep."""
    workers = min(engine.workers, jobs)
    if _seconds_in_process(rules, workers, expected):
        return expected.in_words(1, 1)
    together = min(workers, os.cpu_count() or 1)
    return expected.in_words(workers, together, START_UP * workers / together)


def _seconds_in_process(rules: Rules, workers: int, expected: Estimate) -> float:
    """Return the time, in s, for which this process executes jobs before it starts workers for the rest.

    Workers start if they save more time than the CPU time that their start costs. They execute all jobs if a job may
    not end or may crash its process.
    """
    if workers == 0:
        return math.inf
    together = min(workers, os.cpu_count() or 1)
    pays_from = START_UP * workers * (together + 1) / max(together - 1, 1)
    alone = has_users_parts() or rules.settings.time_limit is not None or expected.known != "about"
    return 0.0 if alone or expected.seconds > pays_from else pays_from


def _begun_in_process(queue: Queue, workers: int, seconds: float) -> Generator[ChunkResult]:
    """Execute jobs in this process for a time, in s, and the rest on workers; yield the report of each chunk."""
    end = time.monotonic() + seconds
    yield from in_process(queue, lambda: time.monotonic() < end)
    if queue.left:
        with local_processes(min(workers, queue.left), _scratch(queue.rules)) as processes:
            yield from on_processes(queue, processes)


def _scratch(rules: Rules) -> Path:
    return rules.sweep / f"{_SCRATCH}{rules.command}"


def clean(rules: Rules, names: Sequence[str]) -> None:
    """Remove temporary files and folders without metrics that killed processes of this or an earlier command left.

    If another command is at work in the outputs folder, run folders stay, because it may be writing one of them.
    """
    others = {f"{_SCRATCH}{command.name}" for command in commands_at_work(rules.sweep)} - {_scratch(rules).name}
    for folder in rules.sweep.glob(f"{_SCRATCH}*"):
        if folder.name not in others:
            shutil.rmtree(folder, ignore_errors=True)
    runs = rules.outputs / "runs"
    for folder in (rules.sweep, rules.sweep / "logs", rules.outputs / "shards", rules.outputs / FINER, runs):
        remove_leftovers(folder)
    is_alone = len(commands_in(rules.outputs)) <= 1
    there = {entry.name for entry in os.scandir(runs)} if is_alone and runs.is_dir() else set()
    for name in there.intersection(names):
        folder = runs / name
        remove_leftovers(folder)
        if not (folder / "metrics.json").exists():
            shutil.rmtree(folder, ignore_errors=True)
