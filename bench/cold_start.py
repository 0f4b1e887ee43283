"""Cost of a typed command until its answer, each in its own process: wall time, and CPU time against Hydra's.

CPU time (user and system) is divided by that of `python -c "import hydra"`, measured in turn with the commands, so that
a busy machine slows both. A report on a sweep is written as HTML and PDF. A TAB at a key composes the config the first
time, and later in the same line reads its keys from a cache; both are measured.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import pybullet_data

REPEATS = 7
TARGET = 0.5  # s, for commands that only print and compute nothing
HELP_TARGET = 0.1  # s
DOCTOR_TARGET = 5.0  # s, for an arm of seven joints with meshes
_RUNNER = str(Path(sys.executable).parent / "runner")
_SWEEP = ("-m", "robot=macro", "trajectory=quintic", "noise=thesis", "repetitions=10", "controller.period=5ms,10ms",
          "controller.natural_frequency=range(10,60,5)")  # fmt: skip
_KUKA = str(Path(pybullet_data.getDataPath()) / "kuka_iiwa" / "model_free_base.urdf")
_HYDRA = (sys.executable, "-c", "import hydra")


@dataclass(frozen=True)
class _Command:
    """A command whose CPU time is divided by that of importing Hydra.

    Attributes:
        name: Description of the row.
        arguments: What follows `runner`; SWEEP is the folder of a sweep.
        target: The largest ratio; None where none is asked for.
        line: The line at whose end TAB is pressed; empty for a command.
        first: Whether the cache folder is empty.
    """

    name: str
    arguments: tuple[str, ...]
    target: float | None
    line: str = ""
    first: bool = False


_COMMANDS = (
    _Command("runner robot=macro, stored already", ("robot=macro",), 2.5),
    _Command("runner report nosuch", ("report", "nosuch"), 0.3),
    _Command("runner report SWEEP, of 20 runs", ("report", "SWEEP", "--output", "report"), 15.0),
    *(
        _Command(f"TAB at `runner {line}`", (), target, f"runner {line}", first)
        for line, target, first in (
            ("rep", 0.2, False),
            ("list r", 0.2, False),
            ("robot=m", 1.3, False),
            ("table --", 1.3, False),
            ("report ", 1.3, False),
            ("reproduce ", 1.3, False),
            ("robot=macro controller.p", 1.3, False),
            ("tune --minimize s", 1.3, False),
            ("robot=macro controller.p", None, True),
            ("tune --minimize s", None, True),
        )
    ),
)


def main(rounds: int | None = None) -> bool:
    """Measure and print; return whether every target is met.

    Args:
        rounds: Number of rounds; None for REPEATS.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        return all([_wall_times(folder, rounds or REPEATS), _ratios(folder, rounds or REPEATS)])


def _wall_times(folder: Path, rounds: int) -> bool:
    print(f"wall time of a command, median of {rounds}")
    fresh = [_wall(folder, "robot=macro", f"seed={seed}") for seed in range(rounds)]
    print(f"  {'runner robot=macro, simulated':50} {median(fresh):5.2f} s")
    return all(
        [
            _judge("runner --help", _repeat(folder, rounds, "--help"), HELP_TARGET),
            _judge("runner list robots", _repeat(folder, rounds, "list", "robots"), TARGET),
            _judge("runner doctor, KUKA iiwa", _repeat(folder, rounds, "doctor", _KUKA), DOCTOR_TARGET),
        ]
    )


def _ratios(folder: Path, rounds: int) -> bool:
    print(f'CPU time of a command against `python -c "import hydra"`, in turn, median of {rounds}')
    found: dict[_Command, list[float]] = {}
    hydra: list[float] = []
    kept = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
    _cpu(folder, [_RUNNER, *_SWEEP], kept)
    (sweep,) = (folder / "outputs" / "sweeps").iterdir()

    def words(command: _Command) -> list[str]:
        return [_RUNNER, *(str(sweep) if word == "SWEEP" else word for word in command.arguments)]

    for command in _COMMANDS:  # so that all is compiled, stored and kept
        _cpu(folder, words(command), _environment(command, kept))
    for repeat in range(rounds):
        hydra.append(_cpu(folder, _HYDRA, kept))
        for number, command in enumerate(_COMMANDS):
            cache = {"XDG_CACHE_HOME": str(folder / f"empty_{repeat}_{number}")} if command.first else {}
            environment = _environment(command, {**kept, **cache})
            found.setdefault(command, []).append(_cpu(folder, words(command), environment))
    print(f"  {'import hydra':50} {median(hydra):5.2f} s")
    met = [_judge_ratio(command, median(seconds), median(hydra)) for command, seconds in found.items()]
    return all(met)


def _environment(command: _Command, base: Mapping[str, str]) -> dict[str, str]:
    if not command.line:
        return dict(base)
    asked = {"_ARGCOMPLETE": "1", "_ARGCOMPLETE_STDOUT_FILENAME": os.devnull}
    return {**base, **asked, "COMP_LINE": command.line, "COMP_POINT": str(len(command.line))}


def _cpu(folder: Path, words: Sequence[str], environment: Mapping[str, str]) -> float:
    """Return the CPU time of a process and its children, in s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, cwd=folder, env=environment, capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _repeat(folder: Path, rounds: int, *arguments: str) -> float:
    return median(_wall(folder, *arguments) for _ in range(rounds))


def _wall(folder: Path, *arguments: str) -> float:
    start = time.perf_counter()
    subprocess.run([_RUNNER, *arguments], cwd=folder, capture_output=True, check=True)
    return time.perf_counter() - start


def _judge(what: str, seconds: float, target: float) -> bool:
    print(f"  {what:50} {seconds:5.2f} s  target {target:g}: {'met' if seconds <= target else 'MISSED'}")
    return seconds <= target


def _judge_ratio(command: _Command, seconds: float, hydra: float) -> bool:
    name = command.name + (", the first time" if command.first and command.line else "")
    ratio = seconds / hydra
    met = command.target is None or ratio <= command.target
    told = "" if command.target is None else f"  target {command.target:g}: {'met' if met else 'MISSED'}"
    print(f"  {name:50} {seconds:5.2f} s  ratio {ratio:4.2f}{told}")
    return met
