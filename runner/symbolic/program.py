"""Compiled programs, cached for each process and for each user."""

import ctypes
import hashlib
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np

from runner.base import cache as kept
from runner.base.arrays import FloatArray
from runner.base.paths import package_dir
from runner.symbolic.code import GIVEN, PARS, ROWS, SCRATCH, STATE, TABLE, Part, write_program
from runner.symbolic.engine import Function, evaluator, load, machine_code, processor

LANES = 8
"""Runs that are computed together in a batch; each result is bit-identical to a separate run."""
# The classical Runge-Kutta scheme: fraction of the step for the next stage, and the weights of two sums.
STAGES = np.array([[0.5, 1.0, 1.0], [0.5, 1.0, 2.0], [1.0, 1.0, 2.0], [0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class Expressed:
    """A program as expressions; see runner/symbolic/code.py.

    Attributes:
        ticks: Code of each tick.
        between: Code from one tick to the next.
        widths: Numbers in a row of each space.
        errors: Messages of the possible failures, in the order of their numbers.
    """

    ticks: Sequence[Part]
    between: Sequence[Part]
    widths: Mapping[str, int]
    errors: Sequence[str]


@dataclass(frozen=True)
class Program:
    """A compiled program.

    Attributes:
        function: The code.
        widths: Numbers in a row of each space.
        errors: Messages of the possible failures, in the order of their numbers.
        lanes: Runs that are computed together.
    """

    function: Function
    widths: Mapping[str, int]
    errors: Sequence[str]
    lanes: int

    def frame(self, ticks: int, delay: int = 0, steps: int = 1, last: int | None = None) -> "Frame":
        """Return arrays for a number of ticks; see Frame."""
        return Frame(self, ticks, delay, steps, ticks - 1 if last is None else last)


class Frame:
    """A program with its input and output arrays.

    Args:
        program: The program.
        ticks: Number of ticks.
        delay: Ticks from a command until it acts.
        steps: Integration steps in a tick.
        last: The tick after which the motion is not integrated.

    Attributes:
        given: Inputs known in advance, shape (ticks, entries, lanes).
        rows: Stored values of each tick, shape (ticks, entries, lanes).
        state: State that continues from tick to tick, shape (entries, lanes).
        pars: Parameters of each run, shape (entries, lanes).
        span: The integers first and end of `write_program`, shape (2,).
        steps: Integration steps in a tick, shape (1,).
    """

    def __init__(self, program: Program, ticks: int, delay: int, steps: int, last: int) -> None:
        widths, lanes = program.widths, program.lanes
        self.given = np.zeros((ticks, widths[GIVEN], lanes))
        self.rows = np.zeros((ticks, widths[ROWS], lanes))
        self.state = np.zeros((widths[STATE], lanes))
        self.pars = np.zeros((widths[PARS], lanes))
        arrays = self.given, self.rows, self.state, np.zeros((widths[SCRATCH], lanes)), self.pars, _table(lanes)
        self._arrays = arrays  # the code holds only their addresses
        frame = np.array([*(array.ctypes.data for array in arrays), 0, ticks, last, delay, steps], dtype=np.int64)
        self.span, self.steps = frame[6:8], frame[10:]
        self._function, self._frame, self._place = program.function, frame, ctypes.c_void_p(frame.ctypes.data)

    def call(self) -> None:
        """Execute the ticks of `span`."""
        self._function(self._place)


@lru_cache(maxsize=2)
def _table(lanes: int) -> FloatArray:
    return np.repeat(STAGES[:, :, None], lanes, axis=2)


def program(pattern: str, what: str, express: Callable[[], Expressed], lanes: int, ours: bool = True) -> Program:
    """Return a program, compiled if it is not cached.

    Args:
        pattern: String that is the same for two programs with the same code.
        what: Description of the compiled code for the user.
        express: Function that returns the expressions.
        lanes: Runs that are computed together.
        ours: True if only built-in code determines the expressions; else the code is not cached on disk.
    """
    content = "\0".join([pattern, source_digest(), str(evaluator()), processor(), str(lanes)])
    return _program(hashlib.sha256(content.encode()).hexdigest(), what, ours, lanes, _Maker(express))


PACKAGES = ("analysis", "assembly", "controllers", "plants", "sensing", "simulation", "symbolic")
"""Packages whose source decides what a program computes; kept machine code of another source is not used."""


class _Maker:
    """Function that returns expressions; all instances are equal, because the cache key identifies the expressions."""

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
        except Exception:  # noqa: S110 - a damaged file may raise any error
            pass
    if sys.stderr.isatty():  # a user is waiting
        print(f"runner: compiling {what}; later runs find it compiled", file=sys.stderr)
    make, maker.make = maker.make, None  # no reference to the first caller remains
    assert make is not None  # noqa: S101 - called once for each key
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
def source_digest() -> str:
    """Return a digest of the source of all packages whose code makes expressions."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        for path in sorted((package_dir() / package).rglob("*.py")):
            digest.update(str(path.relative_to(package_dir())).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
