"""Kills workers and the command itself at random times in a sweep, a study or a tuning; then counts the stored runs."""

import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from runner.store import open_run, open_sweep
from runner.store.shards import read_outcomes

Process = subprocess.Popen[bytes]


@dataclass
class Tally:
    """Killed command, and the effect.

    `lost` are runs that the ended sweep lacks, `doubled` are stored runs that were simulated twice,
    `leftovers` are temporary and half-written files.
    """

    workers: int
    commands: int
    runs: int
    lost: int
    doubled: int
    leftovers: list[str]


def torture(folder: Path, arguments: list[str], workers: int, commands: int, seed: int, pause: float) -> Tally:
    """Run a sweep and kill this many of its workers and commands, each `pause` s after the last on average."""
    return torture_command(folder, ["-m", *arguments], workers, commands, seed, pause)


def torture_command(folder: Path, command: list[str], workers: int, commands: int, seed: int, pause: float) -> Tally:
    """Do the same to any command that simulates, of a sweep, a study or a tuning, in `outputs` of a folder."""
    outputs = folder / "outputs"
    draw = random.Random(seed)  # noqa: S311
    victims = ["worker"] * workers + ["command"] * commands
    draw.shuffle(victims)
    stored = Stored(outputs)
    process = _start(command, folder)
    for victim in victims:
        process = _await_runs(process, command, folder, len(stored.made))
        time.sleep(draw.expovariate(1.0 / pause))
        if victim == "command":
            process.kill()
        else:
            pids = list(_workers_of(process.pid))
            if pids:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(draw.choice(pids), signal.SIGKILL)
        stored.look()
    while process.poll() is None or process.returncode < 0:
        if process.poll() is not None:
            process = _start(command, folder)
        time.sleep(0.1)
    assert process.returncode == 0, process.returncode
    return stored.tally(workers, commands)


class Stored:
    """Runs and shards of an outputs folder, and when each was stored.

    Attributes:
        made: Time at which each was stored, in ns.
    """

    def __init__(self, outputs: Path) -> None:
        self._outputs, self._doubled = outputs, set[str]()
        self.made: dict[Path, int] = {}

    def look(self) -> Mapping[Path, int]:
        """Note when each was stored, and those that were stored again since the last look; return `made`."""
        outputs = self._outputs
        for path in [*(outputs / "runs").glob("*/metrics.json"), *(outputs / "shards").glob("*.parquet")]:
            stored = path.stat().st_mtime_ns
            if self.made.setdefault(path, stored) != stored:
                self._doubled.add(path.parent.name)
        return self.made

    def tally(self, workers: int, commands: int) -> Tally:
        """Count what became of the one sweep or tuning there, which has ended, after some kills."""
        self.look()
        outputs = self._outputs
        (kept,) = [
            *outputs.glob("sweeps/*"),
            *outputs.glob("tunings/*"),
        ]  # several, if the source was changed meanwhile
        sweep = open_sweep(kept)
        rows = Counter(end.name for shard in (outputs / "shards").glob("*.parquet") for end in read_outcomes(shard))
        folders = list((outputs / "runs").iterdir())
        doubled = self._doubled | {name for name, count in rows.items() if count > 1}
        lost = set(sweep.hashes) - {path.name for path in folders} - {*rows}
        hidden = [path for path in outputs.rglob("*") if path.name.startswith((".", "scratch", "at_work"))]
        halves = [path for path in folders if not (path / "metrics.json").exists()]
        leftovers = [str(path) for path in (*hidden, *halves)]
        return Tally(workers, commands, len(sweep.hashes), len(lost), len(doubled), leftovers)


def _start(command: list[str], folder: Path) -> Process:
    words = [sys.executable, "-m", "runner", *command]
    return subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _await_runs(process: Process, command: list[str], folder: Path, known: int) -> Process:
    """Return the process, started again if it was killed, when it simulates runs."""
    while _count(folder / "outputs") <= known:
        if process.poll() is not None:
            if process.returncode == 0:
                raise RuntimeError("the command ended before all were killed: give it more runs")
            process = _start(command, folder)
        time.sleep(0.02)
    return process


def _count(outputs: Path) -> int:
    return sum(1 for _ in (outputs / "runs").glob("*/metrics.json")) + sum(
        1 for _ in (outputs / "shards").glob("*.parquet")
    )


def _workers_of(pid: int) -> Iterator[int]:
    for child in _children(pid):
        with contextlib.suppress(OSError):
            if b"fork_workers" in Path(f"/proc/{child}/cmdline").read_bytes():
                yield from _children(child)


def _children(pid: int) -> Iterator[int]:
    for tasks in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            yield from map(int, tasks.read_text().split())


def _metrics(outputs: Path) -> dict[str, object]:
    """Return the metrics of all runs of an outputs folder, by name."""
    return {path.name: open_run(path).record["metrics"] for path in (outputs / "runs").iterdir()}


def _reports(folder: Path) -> list[bytes]:
    return [path.read_bytes() for path in sorted(folder.rglob("report.*"))]


def _is_as_undisturbed(name: str, command: list[str], kills: tuple[int, int], pause: float) -> bool:
    """Kill a command at work; return True if its runs and reports are those of an undisturbed one."""
    with tempfile.TemporaryDirectory() as folder:
        alone, killed = Path(folder, "alone"), Path(folder, "killed")
        for place in (alone, killed):
            place.mkdir()
        assert _start(command, alone).wait() == 0
        tally = torture_command(killed, command, *kills, 1, pause)
        equal = _metrics(alone / "outputs") == _metrics(killed / "outputs")
        same = [a == b for a, b in zip(_reports(alone), _reports(killed), strict=True)]
    print(f"{name}: {tally}, metrics equal: {equal}, reports equal: {all(same)} ({len(same)})")
    return tally.lost == 0 and tally.doubled == 0 and not tally.leftovers and equal and all(same)


def main() -> bool:
    """Kill 25 times in each of two sweeps, ten times in a study and in a tuning; return whether all is as it should."""
    arguments = ["robot=macro", "trajectory=quintic", "noise=thesis", "seed=range(0,2000)", "repetitions=4"]
    met = True
    for trace in ("all", "never"):
        with tempfile.TemporaryDirectory() as folder:
            tally = torture(Path(folder), [*arguments, f"sweep.trace={trace}"], 15, 10, seed=1, pause=1.0)
        print(tally)
        met = met and tally.lost == 0 and tally.doubled == 0 and not tally.leftovers
    tuned = "controller.natural_frequency=interval(5,40)"
    tuning = ["tune", *arguments[:3], tuned, "--minimize=max_tracking_error", "--trials=200"]
    studies = (("reproduce", ["reproduce", "xarm7"]), ("tune", tuning))
    for name, command in studies:
        met = _is_as_undisturbed(name, command, (5, 5), 1.0) and met
    return met
