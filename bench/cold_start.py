"""Wall time from a typed command to its answer, each in a process of its own."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import pybullet_data

REPEATS = 7
TARGET = 0.5  # s, for what only tells and computes nothing
DOCTOR_TARGET = 5.0  # s, for an arm of seven joints with meshes
_RUNNER = str(Path(sys.executable).parent / "runner")
_KUKA = str(Path(pybullet_data.getDataPath()) / "kuka_iiwa" / "model_free_base.urdf")
_COMPLETE = {"COMP_LINE": "runner robot=m", "COMP_POINT": "14"}


def main() -> bool:
    """Measure and print; return whether every target is met."""
    print(f"wall time of a command, median of {REPEATS}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        fresh = [_time(folder, "robot=macro", f"seed={seed}") for seed in range(REPEATS)]
        print(f"  {'runner robot=macro, simulated':34} {median(fresh):5.2f} s")
        print(f"  {'runner robot=macro, found stored':34} {_repeat(folder, 'robot=macro', 'seed=0'):5.2f} s")
        return all(
            [
                _judge("runner --help", _repeat(folder, "--help")),
                _judge("runner list robots", _repeat(folder, "list", "robots")),
                _judge("completion of robot=m", _repeat(folder, "-sc", "query=bash", environment=_COMPLETE)),
                _judge("runner doctor, KUKA iiwa", _repeat(folder, "doctor", _KUKA), DOCTOR_TARGET),
            ]
        )


def _repeat(folder: Path, *arguments: str, environment: dict[str, str] | None = None) -> float:
    return median(_time(folder, *arguments, environment=environment) for _ in range(REPEATS))


def _time(folder: Path, *arguments: str, environment: dict[str, str] | None = None) -> float:
    start = time.perf_counter()
    subprocess.run(
        [_RUNNER, *arguments], cwd=folder, env={**os.environ, **(environment or {})}, capture_output=True, check=True
    )
    return time.perf_counter() - start


def _judge(what: str, seconds: float, target: float = TARGET) -> bool:
    print(f"  {what:34} {seconds:5.2f} s  target {target:g}: {'met' if seconds <= target else 'MISSED'}")
    return seconds <= target
