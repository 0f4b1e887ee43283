"""Command lines from a grammar, each in its own process: every one ends with a code and words, and soon."""

import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from random import Random

from tools.fuzz import configs
from tools.fuzz.files import experiment
from tools.fuzz.grammar import TEXTS, override

_WALL = 120.0  # s
_PLAIN = ("robot=macro", "duration=0.05")
_COMMANDS = (
    "list",
    "check",
    "compare",
    "table",
    "status",
    "report",
    "audit",
    "doctor",
    "calibrate",
    "--cfg",
    "--nope",
    "nope",
)


@dataclass(frozen=True)
class Measured:
    """Outcome of a command line.

    Attributes:
        code: Exit code, below 0 where a signal ended it, or None where it did not end.
        printed: Its output.
        seconds: CPU time.
        megabytes: Most memory that it held.
    """

    code: int | None
    printed: str
    seconds: float
    megabytes: float


def line(seed: int, number: int, folder: Path) -> list[str]:
    """Return a command line, and write the config folder that it may name."""
    draw = Random(f"{seed} line {number}")  # noqa: S311 - no secrets
    base = draw.choice(configs.BASES)
    places, config = configs.base_config(base)
    if draw.random() < 0.15:
        words = [draw.choice(_COMMANDS), *(draw.choice((*TEXTS, *base, "--help")) for _ in range(draw.randrange(3)))]
        return [_word(word) for word in words]
    words = [*base, *(override(draw, config, places, configs.options()) for _ in range(draw.choice((1, 1, 2))))]
    if draw.random() < 0.3:
        (folder / "own" / "experiment").mkdir(parents=True, exist_ok=True)
        (folder / "own" / "experiment" / "fuzz.yaml").write_text(experiment(draw, config, places), encoding="utf-8")
        words = [*base, "--config-dir", "own", "experiment=fuzz"]
    if draw.random() < 0.2:
        words = ["-m", *words, "hydra.sweeper.workers=0", "seed=1,2"]
    return [_word(word) for word in (*words, "duration=0.05", "repetitions=1")]


def measure(words: list[str], folder: Path) -> Measured:
    """Run a command line in a folder."""
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen([sys.executable, "-m", "runner", *words], cwd=folder, stdout=output, stderr=output)
        deadline = time.monotonic() + _WALL
        while True:
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > deadline:
                process.kill()
            time.sleep(0.02)
        output.seek(0)
        printed = output.read().decode(errors="replace")
    process.returncode = os.waitstatus_to_exitcode(status)  # it is no longer there to be asked
    code = None if time.monotonic() > deadline else process.returncode
    return Measured(code, printed, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0)


def plain() -> Measured:
    """Return the cost of a command line without a fault."""
    with tempfile.TemporaryDirectory() as name:
        return measure(list(_PLAIN), Path(name))


def judge(measured: Measured, usual: Measured) -> list[str]:
    """Return the problem of a command line's outcome, compared with one without a fault."""
    faults = []
    if measured.code not in (0, 1, 2):
        faults.append("not ended" if measured.code is None else f"exit code {measured.code}")
    if "Traceback (most recent call last)" in measured.printed:
        faults.append(f"traceback: {measured.printed.strip().splitlines()[-1][:200]}")
    if measured.seconds > usual.seconds + configs.CPU:
        faults.append(f"{measured.seconds:.1f} s of CPU time")
    if measured.megabytes > usual.megabytes + configs.MEMORY:
        faults.append(f"{measured.megabytes:.0f} MB of memory")
    return faults + (configs.judge(measured.printed) if measured.code == 2 else [])


def _word(text: str) -> str:
    """Return a string as a word of a command line, which holds no zero byte."""
    return text.replace("\0", "?")
