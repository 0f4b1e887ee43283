"""LLVM intermediate representation of programs: straight-line code inside loops, and its memory layout."""

import platform
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from runner.symbolic.expression import Expression, expression, in_order, place
from runner.symbolic.vectors import Vector

GIVEN, ACTING, ROWS, STATE, SCRATCH, PARS, TABLE = "given", "acting", "rows", "state", "scratch", "pars", "table"
ARRAYS = (GIVEN, ROWS, STATE, SCRATCH, PARS, TABLE)
INTEGERS = ("first", "end", "last", "delay", "steps")
_COMPARISONS = {"less": "fcmp olt", "equal": "fcmp oeq"}
_FUNCTIONS = ("sqrt", "fabs", "rint", "floor")
_LIBRARY = ("sin", "cos")  # of the C library
_TOGETHER = platform.system() == "Linux"  # whose C library computes both at once, with the same bits


@dataclass(frozen=True)
class Block:
    """Numbers that are computed and written to slots; all slots are read before any is written.

    Attributes:
        outputs: Space, index and value of each number.
    """

    outputs: Sequence[tuple[str, int, Any]]


@dataclass(frozen=True)
class Repeat:
    """Parts that are executed one or more times.

    Attributes:
        parts: The parts.
        times: Number of repetitions, or the name of an integer of the program.
        until_zero: Index in scratch of a number that ends the loop if it is zero in all runs; None for none.
        tabled: True if each repetition uses the next row of the table.
    """

    parts: Sequence["Part"]
    times: int | str
    until_zero: int | None = None
    tabled: bool = False


Part = Block | Repeat


def write_program(ticks: Sequence[Part], between: Sequence[Part], widths: Mapping[str, int], lanes: int) -> str:
    """Return a program as an LLVM module with the function `run`.

    Its argument is a frame: the addresses of the arrays given, rows, state, scratch, pars and table, and the integers
    first, end, last, delay and steps. It executes the ticks from first to end - 1. The code between two ticks is
    skipped after the tick `last`. The numbers of a slot, one for each run of a batch, are contiguous. `given`, `rows`
    and `acting` have a row for each tick. acting is the row of `delay` ticks ago, or of tick 0 in the first ticks.

    Args:
        ticks: Code of each tick.
        between: Code from one tick to the next.
        widths: Numbers in a row of each space.
        lanes: Runs that are computed together.
    """
    return _Writer(widths, lanes).write(ticks, between)


class _Writer:
    def __init__(self, widths: Mapping[str, int], lanes: int) -> None:
        self._widths, self._lanes = widths, lanes
        self._number, self._truth = ("double", "i1") if lanes == 1 else (f"<{lanes} x double>", f"<{lanes} x i1>")
        self._lines: list[str] = []
        self._count, self._label = 0, "entry"
        self._rows = {space: f"%{space}" for space in (STATE, SCRATCH, PARS)}
        self._used: dict[str, None] = {}  # declarations of functions
        self._buffers: list[str] = []  # of the C library's sine and cosine
        self._turns: dict[str, tuple[str, str]] = {}  # sine and cosine of angles in this block

    def write(self, ticks: Sequence[Part], between: Sequence[Part]) -> str:
        for index, (name, kind) in enumerate([*((n, "ptr") for n in ARRAYS), *((n, "i64") for n in INTEGERS)]):
            self._lines.append(f"  %{name}.at = getelementptr i64, ptr %frame, i64 {index}")
            self._lines.append(f"  %{name} = load {kind}, ptr %{name}.at")
        head, k = self._open("%first")
        late = self._line(f"sub i64 {k}, %delay")
        early = self._line(f"icmp slt i64 {late}, 0")
        acting = self._line(f"select i1 {early}, i64 0, i64 {late}")
        self._rows |= {GIVEN: self._row(GIVEN, k), ROWS: self._row(ROWS, k), ACTING: self._row(ROWS, acting)}
        self._parts(ticks)
        ends = self._line(f"icmp eq i64 {k}, %last")
        moves, moved = self._fresh("moves"), self._fresh("moved")
        self._lines.append(f"  br i1 {ends}, label %{moved}, label %{moves}")
        self._begin(moves)
        self._parts(between)
        self._lines.append(f"  br label %{moved}")
        self._begin(moved)
        self._close(head, k, "%end", None)
        buffers = [f"  {name} = alloca [{self._lanes} x double], align 64" for name in self._buffers]
        body = ["define void @run(ptr %frame) {", "entry:", *buffers, *self._lines, "  ret void", "}", ""]
        return "\n".join([*self._used, *body])

    def _parts(self, parts: Sequence[Part]) -> None:
        for part in parts:
            if isinstance(part, Block):
                self._block(part)
                continue
            head, turn = self._open("0")
            if part.tabled:
                self._rows[TABLE] = self._row(TABLE, turn)
            self._parts(part.parts)
            times = f"%{part.times}" if isinstance(part.times, str) else str(part.times)
            self._close(head, turn, times, part.until_zero)

    def _block(self, block: Block) -> None:
        values = [expression(value) for _, _, value in block.outputs]
        self._turns.clear()
        names: dict[int, str] = {}
        known: dict[tuple[Any, ...], str] = {}
        for node in in_order(values):
            operands = [names[id(part)] if isinstance(part, Expression) else part for part in node.operands]
            key = (node.operation, *operands)
            if key not in known:
                known[key] = self._operation(node.operation, operands)
            names[id(node)] = known[key]
        for (space, index, _), value in zip(block.outputs, values, strict=True):
            self._lines.append(f"  store {self._number} {names[id(value)]}, ptr {self._place(space, index)}, align 8")

    def _operation(self, operation: str, operands: Sequence[Any]) -> str:
        number, truth = self._number, self._truth
        if operation == "constant":
            return self._constant(operands[0])
        if operation == "place":
            return self._line(f"load {number}, ptr {self._place(*operands)}, align 8")
        if operation in _COMPARISONS:
            return self._line(f"{_COMPARISONS[operation]} {number} {operands[0]}, {operands[1]}")
        if operation == "select":
            return self._line(f"select {truth} {operands[0]}, {number} {operands[1]}, {number} {operands[2]}")
        if operation == "and":
            return self._line(f"and {truth} {operands[0]}, {operands[1]}")
        if operation == "not":
            return self._line(f"xor {truth} {operands[0]}, {'true' if self._lanes == 1 else 'splat (i1 true)'}")
        if operation in _FUNCTIONS:
            name = f"{operation}.{'f64' if self._lanes == 1 else f'v{self._lanes}f64'}"
            self._used[f"declare {number} @llvm.{name}({number})"] = None
            return self._line(f"call {number} @llvm.{name}({number} {operands[0]})")
        if operation in _LIBRARY:
            angle = operands[0]
            if angle not in self._turns:
                self._turns[angle] = self._sine_cosine(angle)
            return self._turns[angle][_LIBRARY.index(operation)]
        return self._line(f"{operation} {number} {', '.join(operands)}")

    def _sine_cosine(self, angle: str) -> tuple[str, str]:
        """Return sine and cosine by the C library, run by run."""
        if not self._buffers:
            self._buffers = [f"%{name}.buffer" for name in ("angle", "sine", "cosine")]
            declared = (
                ["void @sincos(double, ptr, ptr)"] if _TOGETHER else [f"double @{name}(double)" for name in _LIBRARY]
            )
            self._used |= dict.fromkeys(f"declare {function}" for function in declared)
        at, sine, cosine = self._buffers
        self._lines.append(f"  store {self._number} {angle}, ptr {at}, align 8")
        for lane in range(self._lanes):
            own, *found = (
                self._line(f"getelementptr double, ptr {buffer}, i64 {lane}") for buffer in (at, sine, cosine)
            )
            value = self._line(f"load double, ptr {own}, align 8")
            if _TOGETHER:
                self._lines.append(f"  call void @sincos(double {value}, ptr {found[0]}, ptr {found[1]})")
                continue
            for name, place_ in zip(_LIBRARY, found, strict=True):
                result = self._line(f"call double @{name}(double {value})")
                self._lines.append(f"  store double {result}, ptr {place_}, align 8")
        one, other = (self._line(f"load {self._number}, ptr {buffer}, align 8") for buffer in (sine, cosine))
        return one, other

    def _constant(self, value: float) -> str:
        bits = struct.unpack(">Q", struct.pack(">d", value))[0]
        return f"0x{bits:016X}" if self._lanes == 1 else f"splat (double 0x{bits:016X})"

    def _place(self, space: str, index: int) -> str:
        return self._line(f"getelementptr double, ptr {self._rows[space]}, i64 {index * self._lanes}")

    def _row(self, space: str, row: str) -> str:
        width = self._widths[ROWS if space == ACTING else space] * self._lanes
        return self._line(f"getelementptr double, ptr %{space}, i64 {self._line(f'mul i64 {row}, {width}')}")

    def _open(self, first: str) -> tuple[str, str]:
        """Begin a loop; return its label and its counter."""
        head, before = self._fresh("loop"), self._label
        self._lines.append(f"  br label %{head}")
        self._begin(head)
        counter = f"%{head}.k"
        self._lines.append(f"  {counter} = phi i64 [ {first}, %{before} ], [ {counter}.next, %{head}.end ]")
        return head, counter

    def _close(self, head: str, counter: str, times: str, until_zero: int | None) -> None:
        """End a loop after a number of turns, or if a number is zero in all runs."""
        goes_on = None if until_zero is None else self._any(until_zero)
        self._lines.append(f"  br label %{head}.end")
        self._begin(f"{head}.end")
        self._lines.append(f"  {counter}.next = add i64 {counter}, 1")
        again = self._line(f"icmp slt i64 {counter}.next, {times}")
        if goes_on is not None:
            again = self._line(f"and i1 {again}, {goes_on}")
        after = self._fresh("after")
        self._lines.append(f"  br i1 {again}, label %{head}, label %{after}")
        self._begin(after)

    def _any(self, index: int) -> str:
        """Return the condition that a number of scratch is not zero in at least one run."""
        value = self._line(f"load {self._number}, ptr {self._place(SCRATCH, index)}, align 8")
        found = self._line(f"fcmp une {self._number} {value}, {self._constant(0.0)}")
        if self._lanes == 1:
            return found
        bits = self._line(f"bitcast {self._truth} {found} to i{self._lanes}")
        return self._line(f"icmp ne i{self._lanes} {bits}, 0")

    def _begin(self, label: str) -> None:
        self._lines.append(f"{label}:")
        self._label = label

    def _fresh(self, word: str) -> str:
        self._count += 1
        return f"{word}{self._count}"

    def _line(self, text: str) -> str:
        self._count += 1
        self._lines.append(f"  %v{self._count} = {text}")
        return f"%v{self._count}"


class Slots:
    """Slots in the spaces of one program; see runner/symbolic/code.py."""

    def __init__(self) -> None:
        self.widths = {GIVEN: 0, ROWS: 0, STATE: 0, SCRATCH: 0, PARS: 0, TABLE: 3}
        """Number of slots in use in each space."""

    def take(self, space: str, count: int) -> tuple[int, list[Expression]]:
        """Return the index of the first of `count` new slots, and the slots as expressions."""
        first = self.widths[space]
        self.widths[space] += count
        return first, [place(space, first + index) for index in range(count)]

    def keep(self, values: Vector, parts: list[Part]) -> Vector:
        """Add the code that writes numbers to new slots, for later parts; return the slots. Constants stay floats."""
        first, kept = self.take(SCRATCH, sum(isinstance(value, Expression) for value in values))
        parts.append(put(SCRATCH, first, [value for value in values if isinstance(value, Expression)]))
        slots = iter(kept)
        return [next(slots) if isinstance(value, Expression) else value for value in values]

    def number(self, value: float) -> Expression:
        """Return the next parameter, for a number that may differ between runs; see Values."""
        return self.take(PARS, 1)[1][0]


def put(space: str, first: int, values: Vector) -> Block:
    """Return the code that writes values to consecutive slots."""
    return Block([(space, first + index, value) for index, value in enumerate(values)])
