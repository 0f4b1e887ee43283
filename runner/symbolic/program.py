"""Compiled programs, cached for each process and for each user."""

import ctypes
import hashlib
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.paths import package_dir
from runner.symbolic import cache as kept
from runner.symbolic.code import GIVEN, PARS, ROWS, SCRATCH, STATE, TABLE, Part, write_program
from runner.symbolic.engine import Function, evaluator, load, machine_code, processor

LANES = 8
"""Runs that are computed together in a batch; each has the bits that it has alone."""
# The classical Runge-Kutta scheme: the next stage's part of the step, and the weights of two sums.
STAGES = np.array([[0.5, 1.0, 1.0], [0.5, 1.0, 2.0], [1.0, 1.0, 2.0], [0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class Expressed:
    """A program as expressions; see runner/symbolic/code.py.

    Attributes:
        ticks: What each tick does.
        between: What leads to the next tick.
        widths: Numbers in a row of each space.
        errors: Texts of what may go wrong, in the order of their numbers.
    """

    ticks: Sequence[Part]
    between: Sequence[Part]
    widths: Mapping[str, int]
    errors: Sequence[str]


@dataclass(frozen=True)
class Program:
    """A compiled program.

    Attributes:
        function: Its code.
        widths: Numbers in a row of each space.
        errors: Texts of what may go wrong, in the order of their numbers.
        lanes: Runs that are computed together.
    """

    function: Function
    widths: Mapping[str, int]
    errors: Sequence[str]
    lanes: int

    def frame(self, ticks: int, delay: int = 0, steps: int = 1, last: int | None = None) -> "Frame":
        """Return arrays for so many ticks; see Frame."""
        return Frame(self, ticks, delay, steps, ticks - 1 if last is None else last)


class Frame:
    """A program with the arrays that it reads and writes.

    Args:
        program: The program.
        ticks: Number of ticks.
        delay: Ticks from a command until it acts.
        steps: Steps of the plant in a tick.
        last: The tick after which nothing moves.

    Attributes:
        given: Known before, shape (ticks, entries, lanes).
        rows: What is kept of each tick, shape (ticks, entries, lanes).
        state: What goes on from tick to tick, shape (entries, lanes).
        pars: Numbers of each run, shape (entries, lanes).
        span: The integers first and end of `written`, shape (2,).
        steps: Steps of the plant in a tick, shape (1,).
    """

    def __init__(self, program: Program, ticks: int, delay: int, steps: int, last: int) -> None:
        widths, lanes = program.widths, program.lanes
        self.given = np.zeros((ticks, widths[GIVEN], lanes))
        self.rows = np.zeros((ticks, widths[ROWS], lanes))
        self.state = np.zeros((widths[STATE], lanes))
        self.pars = np.zeros((widths[PARS], lanes))
        arrays = self.given, self.rows, self.state, np.zeros((widths[SCRATCH], lanes)), self.pars, _table(lanes)
        self._arrays = arrays  # the code holds their addresses alone
        frame = np.array([*(array.ctypes.data for array in arrays), 0, ticks, last, delay, steps], dtype=np.int64)
        self.span, self.steps = frame[6:8], frame[10:]
        self._function, self._frame, self._place = program.function, frame, ctypes.c_void_p(frame.ctypes.data)

    def call(self) -> None:
        """Go through the ticks of `span`."""
        self._function(self._place)


@lru_cache(maxsize=2)
def _table(lanes: int) -> FloatArray:
    return np.repeat(STAGES[:, :, None], lanes, axis=2)


def program(pattern: str, what: str, express: Callable[[], Expressed], lanes: int, ours: bool = True) -> Program:
    """Return a program, compiled now where that was not done before.

    Args:
        pattern: The same for two programs whose code is the same.
        what: What is compiled, as the user is told.
        express: Makes its expressions.
        lanes: Runs that are computed together.
        ours: Whether they follow from our source alone; else nobody knows when kept code is out of date.
    """
    content = "\0".join([pattern, _source_digest(), str(evaluator()), processor(), str(lanes)])
    return _program(hashlib.sha256(content.encode()).hexdigest(), what, ours, lanes, _Maker(express))


class _Maker:
    """What makes expressions; any two are equal, as the key beside it says which ones."""

    def __init__(self, make: Callable[[], Expressed]) -> None:
        self.make: Callable[[], Expressed] | None = make

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Maker)

    def __hash__(self) -> int:
        return 0


@lru_cache(maxsize=64)
def _program(key: str, what: str, ours: bool, lanes: int, maker: _Maker) -> Program:
    found = kept.read(key) if ours else None
    if found is not None:
        try:
            return _loaded(found[0], found[1]["widths"], found[1]["errors"], lanes)
        except Exception:  # noqa: S110 - whatever a damaged file makes the library raise
            pass
    if sys.stderr.isatty():  # somebody waits
        print(f"runner: compiling {what}; later runs find it compiled", file=sys.stderr)
    make, maker.make = maker.make, None  # nothing of the first caller is kept
    assert make is not None  # noqa: S101 - asked once for each key
    expressed = make()
    code = machine_code(write_program(expressed.ticks, expressed.between, expressed.widths, lanes))
    if ours:
        kept.write(key, code, {"widths": dict(expressed.widths), "errors": list(expressed.errors)})
    return _loaded(code, expressed.widths, expressed.errors, lanes)


def _loaded(code: bytes, widths: Mapping[str, int], errors: Sequence[str], lanes: int) -> Program:
    wanted = {GIVEN, ROWS, STATE, SCRATCH, PARS, TABLE}
    if set(widths) != wanted or not all(isinstance(width, int) for width in widths.values()):
        raise ValueError("it has not the widths of a program")
    return Program(load(code), dict(widths), tuple(errors), lanes)


@cache
def _source_digest() -> str:
    """Return a digest of the source that makes expressions."""
    digest = hashlib.sha256()
    for room in ("compiled", "controllers"):
        for path in sorted((package_dir() / room).glob("*.py")):
            digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
