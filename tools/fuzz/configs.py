"""Configs from a grammar, composed, checked and run for some ticks: each is soon taken, or refused with a message.

Messages are judged by `attempt`, what a case costs by `judge_costs`: that depends on the machine.
"""

import json
import resource
import signal
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, Literal

from runner.assembly.validation import validate
from runner.base.errors import RunnerError
from runner.config.compose.compose import compose
from runner.config.compose.files import group_options, groups
from runner.config.composed import Composed
from runner.simulation.run import simulate_run
from runner.store import run_hash
from runner.sweeps.records import make_record
from tools.fuzz.files import experiment
from tools.fuzz.grammar import keys_of, mutated, override

CPU = 5.0  # s, over what a sound case takes
MEMORY = 500  # MB
REFUSAL = 10_000  # characters
_HANGS = 300  # s of CPU time, which only ends what would not end
_TICKS = 3
_LONG = 20_000  # ticks: the path of a run that is meant to be longer takes as long to check
BASES = (
    ("robot=macro",), ("robot=mini", "controller=whole_body"), ("robot=combined",), ("robot=xarm7",),
    ("robot=meca500", "environment=wall"), ("robot=macro", "trajectory=waypoints"), ("robot=xarm7_mini",),
    ("robot=xarm7", "controller=computed_torque", "plant=rk4"),
)  # fmt: skip

Kind = Literal["resolved", "overrides", "file"]


@dataclass(frozen=True)
class Case:
    """One config.

    Attributes:
        number: Its number, which determines it together with the seed.
        kind: A resolved config, overrides, or an experiment's file.
        content: The config, the overrides, or the file's text.
        base: Overrides that come with a file.
    """

    number: int
    kind: Kind
    content: Any
    base: tuple[str, ...]


@dataclass(frozen=True)
class Ended:
    """Outcome of a case.

    Attributes:
        refused: Whether it was refused; else it was taken.
        faults: What is wrong with how it ended.
        seconds: CPU time.
        megabytes: Memory that it took next to what the process had held before.
    """

    refused: bool
    faults: list[str]
    seconds: float = 0.0
    megabytes: float = 0.0


class _HangError(BaseException):
    """A case takes too long."""


def case(seed: int, number: int) -> Case:
    """Return a case; the same for the same seed and number."""
    draw = Random(f"{seed} {number}")  # noqa: S311 - no secrets
    base = draw.choice(BASES)
    places, config = base_config(base)
    kind: Kind = draw.choice(("resolved", "resolved", "resolved", "overrides", "file"))
    if kind == "resolved":
        return Case(number, kind, mutated(draw, config), base)
    if kind == "overrides":
        return Case(
            number, kind, [override(draw, config, places, options()) for _ in range(draw.choice((1, 1, 2, 3)))], base
        )
    return Case(number, kind, experiment(draw, config, places), base)


def attempt(given: Case, folder: Path) -> Ended:
    """Compose and check a case, and simulate some ticks where it is taken; `folder` is for its file."""
    start, size = time.process_time(), _megabytes()
    refused, faults = False, []
    try:
        with _no_longer_than(_HANGS):
            resolved = _resolve(given, folder)
            config = validate(Composed(resolved, config_dirs=(folder,)))
            run_hash(resolved, config.arm.urdf)
            if config.path.duration < _LONG * config.timing.tick:
                _run_briefly(resolved, config.timing.tick, folder)
    except RunnerError as error:
        refused, faults = True, judge(str(error))
    except _HangError:
        faults = [f"not ended after {_HANGS} s"]
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        faults = [f"traceback: {type(error).__name__}: {str(error)[:200]}"]
    return Ended(refused, faults, time.process_time() - start, _megabytes() - size)


def judge_costs(ended: Ended) -> list[str]:
    """Return the problem of a case's time or memory."""
    faults = [f"{ended.seconds:.1f} s of CPU time"] if ended.seconds > CPU else []
    return faults + ([f"{ended.megabytes:.0f} MB of memory"] if ended.megabytes > MEMORY else [])


def judge(text: str) -> list[str]:
    """Return the problem of a message."""
    faults = [f"a message of {len(text)} characters"] if len(text) > REFUSAL else []
    strange = [sign for sign in text if not sign.isprintable() and sign != "\n"]
    return faults + ([f"control characters in a message: {strange[:5]!r}"] if strange else [])


@cache
def options() -> list[str]:
    """Return the overrides that choose an option of a group, and some that choose none."""
    found = [f"{group}={name}" for group in groups() for name in group_options(group)]
    return [*found, "robot=nope", "robot=", "robot=null", "noise=[]", "noise={a: 1}", "robot=macro,mini", "~noise"]


@cache
def base_config(overrides: tuple[str, ...]) -> tuple[list[tuple[Any, ...]], dict[str, Any]]:
    """Return the places of all values in a sound config, and the config itself."""
    config: Any = compose(overrides).resolved
    return keys_of(config), config


def _resolve(given: Case, folder: Path) -> dict[str, Any]:
    if given.kind == "resolved":
        return dict(given.content)
    overrides = [*given.base, *given.content] if given.kind == "overrides" else [*given.base, "experiment=fuzz"]
    if given.kind == "file":
        (folder / "experiment").mkdir(exist_ok=True)
        (folder / "experiment" / "fuzz.yaml").write_text(given.content, encoding="utf-8")
    return dict(compose(overrides, [folder]).resolved)


def _run_briefly(resolved: dict[str, Any], tick: float, folder: Path) -> None:
    composed = Composed({**resolved, "duration": _TICKS * tick, "repetitions": 1}, (), {}, (folder,))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # numpy's, of a run that diverges: that is a result
        record = make_record(simulate_run(validate(composed)))
    json.dumps(record, allow_nan=False)


@contextmanager
def _no_longer_than(seconds: float) -> Iterator[None]:
    def stop(*_: object) -> None:
        raise _HangError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _megabytes() -> float:
    """Return the most memory that this process has held."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
