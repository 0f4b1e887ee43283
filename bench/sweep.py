"""Cost of a sweep in addition to the simulation: CPU time per run, use of both cores, memory of the parent, and saving.

`python -m bench sweep` makes 2,000 short Macro runs, each with its trace in its own folder; 100,000 of the
shortest kind, which go to shards; and 10,000 of 400 ticks with encoder noise, which are simulated together. Start-up is
what a sweep of two runs costs. `python -m bench.sweep --large` makes 100,000 of the last, start included.
"""

import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from runner import store
from runner.assembly.assemble import assemble
from runner.assembly.validation import validate
from runner.base.engines import quiet_environment
from runner.config.compose.compose import compose
from runner.simulation.loop import simulate
from runner.simulation.run import simulate_run
from runner.simulation.sensors import make_encoders
from runner.sweeps.records import write_run

_SHORT = ("robot=macro", "noise=thesis", "duration=1")
_SHORTEST = ("robot=macro", "plant=rk4", "noise=thesis", "duration=0.05", "sweep.trace=never")
_TOGETHER = (
    *("robot=macro", "plant=rk4", "noise=thesis", "torque_limits=thesis", "trajectory=quintic"),
    *("trajectory.duration=3.5", "duration=4", "controller.natural_frequency=8,10", "sweep.trace=never"),
)
_WORKERS = 2
_BY_WORKERS = "sweep.time_limit=600"  # without it the command simulates two runs itself


@dataclass(frozen=True)
class Cost:
    """CPU time of a command and all its processes, wall-clock time, both in s, and its own peak memory in MB."""

    cpu: float
    wall: float
    memory: float


def main(rounds: int | None = None, large: bool = False) -> bool:
    """Measure and print; return whether every target is met.

    Args:
        rounds: With 1, a hundredth of the runs is made.
        large: Whether to make 100,000 runs of 400 ticks, too, which takes a minute.
    """
    simulating, saving = _simulating(_SHORT), _saving(_SHORT)
    part = 100 if rounds == 1 else 1
    runs, many = 2_000 // part, 100_000 // part
    few, short, shortest = _sweep((*_SHORT, _BY_WORKERS), 2), _sweep(_SHORT, runs), _sweep(_SHORTEST, many)
    overhead = (short.cpu - few.cpu) / runs - simulating
    busy = (short.cpu - few.cpu) / (_WORKERS * (short.wall - few.wall))
    print(f"{runs:,} runs: {short.cpu:.0f} s of CPU, {short.wall:.0f} s, {simulating * 1e3:.1f} ms simulating each")
    print(f"{many:,} runs: {shortest.cpu:.0f} s of CPU, {shortest.wall:.0f} s")
    met = [
        _judge("overhead per run (ms of CPU)", overhead * 1e3, 10.0),
        _judge("both cores idle (share)", 1.0 - busy, 0.1),
        _judge("shortest run, all in all (ms)", shortest.wall / many * 1e3, 5.0),
        _judge("memory of the parent (MB)", max(short.memory, shortest.memory), 500.0),
        _judge("saving a run (ms of CPU)", saving * 1e3, 3.0),
    ]
    start, together = _sweep((*_TOGETHER, _BY_WORKERS), 2), _sweep(_TOGETHER, 10_000 // part)
    cost = (together.cpu - start.cpu) / (10_000 // part)
    met.append(_judge("400 ticks, together (ms of CPU)", cost * 1e3, 0.6))
    if large:
        largest = _sweep(_TOGETHER, 100_000)
        met.append(_judge("100,000, start included (ms)", largest.cpu / 100_000 * 1e3, 0.6))
        met.append(_judge("their parent's memory (MB)", largest.memory, 1500.0))
    return all(met)


def _sweep(overrides: tuple[str, ...], runs: int) -> Cost:
    """Make a sweep through the command line, of this many runs over seeds and what else is swept."""
    seeds = runs // math.prod(text.count(",") + 1 for text in overrides)
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "runner", "-m", *overrides, f"seed=range(0,{seeds})", f"outputs={folder}"]
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        assert status == 0
        done = next(Path(folder).glob("sweeps/*"))
        assert len(store.open_sweep(done).hashes) == runs
    return Cost(used.ru_utime + used.ru_stime, wall, used.ru_maxrss / 1024)


def _simulating(overrides: tuple[str, ...]) -> float:
    config = validate(compose(overrides))
    loop = assemble(config)
    return _cpu_time(lambda: simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0)))


def _saving(overrides: tuple[str, ...]) -> float:
    composed = compose(overrides)
    result = simulate_run(validate(composed))
    with tempfile.TemporaryDirectory() as folder:
        return _cpu_time(lambda: write_run(Path(folder), "run", result))


def _cpu_time(work: Callable[[], object], times: int = 100) -> float:
    work()
    start = time.process_time()
    for _ in range(times):
        work()
    return (time.process_time() - start) / times


def _judge(what: str, value: float, target: float) -> bool:
    print(f"  {what:30} {value:7.2f}  target {target:g}: {'met' if value <= target else 'MISSED'}")
    return value <= target


if __name__ == "__main__":
    quiet_environment()
    sys.exit(0 if main(large="--large" in sys.argv[1:]) else 1)
