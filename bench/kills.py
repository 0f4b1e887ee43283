"""Kills workers and the command itself at random moments of one sweep, until it is done; then counts what is stored."""

import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from runner.store import open_sweep
from runner.store.shards import read_outcomes

Process = subprocess.Popen[bytes]


@dataclass
class Tally:
    """What was killed, and what that did.

    `lost` are runs that the ended sweep lacks, `doubled` such that were made again though they were stored,
    `leftovers` are temporary and half-written files.
    """

    workers: int
    commands: int
    runs: int
    lost: int
    doubled: int
    leftovers: list[str]


def torture(outputs: Path, arguments: list[str], workers: int, commands: int, seed: int, pause: float) -> Tally:
    """Run a sweep and kill so many of its workers and of its commands, each `pause` s after the last on average."""
    draw = random.Random(seed)  # noqa: S311
    victims = ["worker"] * workers + ["command"] * commands
    draw.shuffle(victims)
    made: dict[Path, int] = {}
    doubled: set[str] = set()
    process = _start(arguments, outputs)
    for victim in victims:
        process = _await_runs(process, arguments, outputs, len(made))
        time.sleep(draw.expovariate(1.0 / pause))
        if victim == "command":
            process.kill()
        else:
            pids = list(_workers_of(process.pid))
            if pids:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(draw.choice(pids), signal.SIGKILL)
        doubled |= _look(outputs, made)
    while process.poll() is None or process.returncode < 0:
        if process.poll() is not None:
            process = _start(arguments, outputs)
        time.sleep(0.1)
    doubled |= _look(outputs, made)
    assert process.returncode == 0, process.returncode
    (folder,) = (outputs / "sweeps").iterdir()  # several, if the source was changed meanwhile
    sweep = open_sweep(folder)
    lost = len(set(sweep.hashes)) - sum(1 for _ in sweep.runs())
    rows = Counter(end.name for shard in (outputs / "shards").glob("*.parquet") for end in read_outcomes(shard))
    doubled |= {name for name, count in rows.items() if count > 1}
    hidden = [path for path in outputs.rglob("*") if path.name.startswith(".") or path.name == "scratch"]
    halves = [path for path in (outputs / "runs").iterdir() if not (path / "metrics.json").exists()]
    return Tally(workers, commands, len(sweep.hashes), lost, len(doubled), [str(path) for path in (*hidden, *halves)])


def _start(arguments: list[str], outputs: Path) -> Process:
    command = [sys.executable, "-m", "runner", "-m", *arguments, f"outputs={outputs}"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _await_runs(process: Process, arguments: list[str], outputs: Path, known: int) -> Process:
    """Return the process, started again where it was killed, once it makes runs."""
    while _count(outputs) <= known:
        if process.poll() is not None:
            if process.returncode == 0:
                raise RuntimeError("the sweep ended before all were killed: give it more runs")
            process = _start(arguments, outputs)
        time.sleep(0.02)
    return process


def _count(outputs: Path) -> int:
    return sum(1 for _ in (outputs / "runs").glob("*/metrics.json")) + sum(
        1 for _ in (outputs / "shards").glob("*.parquet")
    )


def _look(outputs: Path, made: dict[Path, int]) -> set[str]:
    """Note when each run was stored; return those that were stored again."""
    again = set()
    for path in [*(outputs / "runs").glob("*/metrics.json"), *(outputs / "shards").glob("*.parquet")]:
        stored = path.stat().st_mtime_ns
        if made.setdefault(path, stored) != stored:
            again.add(path.parent.name)
    return again


def _workers_of(pid: int) -> Iterator[int]:
    children = Path(f"/proc/{pid}/task/{pid}/children").parent.parent
    for tasks in children.glob("*/children"):
        with contextlib.suppress(OSError):
            for child in map(int, tasks.read_text().split()):
                if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes():
                    yield child


def main() -> bool:
    """Kill 20 workers and 10 commands; return whether nothing was lost, doubled or left behind."""
    arguments = ["robot=macro", "trajectory=quintic", "noise=thesis", "seed=range(0,2000)", "repetitions=4"]
    met = True
    for trace in ("all", "never"):
        with tempfile.TemporaryDirectory() as folder:
            tally = torture(Path(folder), [*arguments, f"sweep.trace={trace}"], 20, 10, seed=1, pause=1.0)
        print(tally)
        met = met and tally.lost == 0 and tally.doubled == 0 and not tally.leftovers
    return met
