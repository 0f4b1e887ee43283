"""Measured values with names, conditions on them with text, and findings that state conditions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from runner.base.quantities import ROUNDING as SMALLEST
from runner.base.quantities import format_range, number, quantity
from runner.reporting.document import Document, Notice, NoticeKind
from runner.reporting.outline import chapters
from runner.schema.bound import Range

ROUNDING = 1e-9  # m, rad, N or a ratio: far below the resolution of any run, far above rounding errors


@dataclass(frozen=True)
class Condition:
    """Condition on measured values that makes a sentence true.

    Attributes:
        text: The condition, written out.
        holds: Whether it is true; a value that is missing makes it false.
        measured: The values in it with their names.
        values: The values, without numbers that are typed into it.
    """

    text: str
    holds: bool
    measured: str
    values: tuple[Measured, ...] = field(default=(), repr=False)  # `measured` shows them

    def __bool__(self) -> bool:
        """Refuse: a branch of prose that hangs on a condition says something that no condition guards."""
        raise TypeError(f"'{self.text}' chooses no words; hand it to finding(), which says when it no longer holds")


@dataclass(frozen=True)
class Measured:
    """A number from stored runs.

    Attributes:
        name: What it is, in a few words, such as "tip error of the pair".
        value: The number; None for a metric without a value.
        unit: Its unit.
        parts: The measured values from which it was computed; empty if it was not.
    """

    name: str
    value: float | None
    unit: str = "1"
    parts: tuple[Measured, ...] = ()

    def __str__(self) -> str:
        """Return the value in a sentence, with its unit: "less than 1·10⁻¹² m" for the size of rounding errors."""
        return self._above(SMALLEST)

    @property
    def shown(self) -> str:
        """The value in a sentence on a number that must vanish: "less than 1 nm" if it does."""
        return self._above(100.0 * ROUNDING if self.unit == "%" else ROUNDING)

    def _above(self, limit: float) -> str:
        small = self.value is not None and 0.0 < abs(self.value) < limit
        return f"less than {quantity(limit, self.unit)}" if small else quantity(self.value, self.unit)

    def with_other(self, other: Measured) -> str:
        """Return it and another value of the same kind in one unit, such as "0.775 and 108 mm"."""
        return format_range(self.value, other.value, self.unit, word="and")

    def __mul__(self, factor: float) -> Measured:
        """Return it times a factor."""
        return self._worked_out(f"{number(factor)} times {self.name}", lambda value: factor * value, self.unit)

    __rmul__ = __mul__

    def __truediv__(self, other: Measured | float) -> Measured:
        """Return it divided by a number, or its ratio to another value."""
        if isinstance(other, Measured):
            unit = "1" if other.unit == self.unit else f"{self.unit}/{other.unit}"
            return self._with(other, f"{self.name} over {other.name}", lambda a, b: a / b if b else math.inf, unit)
        return self._worked_out(f"{self.name} over {number(other)}", lambda value: value / other, self.unit)

    def __sub__(self, other: Measured) -> Measured:
        """Return the difference to another value."""
        return self._with(other, f"{self.name} less {other.name}", lambda a, b: a - b, self.unit)

    def __lt__(self, other: Measured | float) -> Condition:
        """Return the condition that it is smaller."""
        return self._compare(other, "<", lambda a, b: a < b)

    def __le__(self, other: Measured | float) -> Condition:
        """Return the condition that it is not larger."""
        return self._compare(other, "≤", lambda a, b: a <= b)

    def __gt__(self, other: Measured | float) -> Condition:
        """Return the condition that it is larger."""
        return self._compare(other, ">", lambda a, b: a > b)

    def __ge__(self, other: Measured | float) -> Condition:
        """Return the condition that it is not smaller."""
        return self._compare(other, "≥", lambda a, b: a >= b)

    def near(self, other: Measured | float, share: float) -> Condition:
        """Return the condition that its relative difference to another value is at most `share`."""
        right = _as_measured(other, self.unit)
        text = f"{self.name} within {number(100.0 * share)} % of {right.name}"
        return _condition(text, self, right, lambda a, b: Range(-share * abs(b), share * abs(b)).holds(a - b))

    def _compare(self, other: Measured | float, sign: str, holds: Callable[[float, float], bool]) -> Condition:
        right = _as_measured(other, self.unit)
        return _condition(f"{self.name} {sign} {right.name}", self, right, holds)

    def _worked_out(self, name: str, work: Callable[[float], float], unit: str) -> Measured:
        value = None if self.value is None else work(self.value)
        return Measured(name, value, unit, self.parts or (self,))

    def _with(self, other: Measured, name: str, work: Callable[[float, float], float], unit: str) -> Measured:
        value = None if self.value is None or other.value is None else work(self.value, other.value)
        return Measured(name, value, unit, (self.parts or (self,)) + (other.parts or (other,)))


def _as_measured(value: Measured | float, unit: str) -> Measured:
    return value if isinstance(value, Measured) else Measured(quantity(value, unit), value, unit)


def _literal(part: Measured) -> str:
    """Return the name of a number that is typed into a condition."""
    return quantity(part.value, part.unit)


def _condition(text: str, left: Measured, right: Measured, holds: Callable[[float, float], bool]) -> Condition:
    found = dict.fromkeys(part for side in (left, right) for part in (side.parts or (side,)))
    parts = tuple(part for part in found if part.name != _literal(part))
    told = [f"{part.name}: {part if _has(part) else 'has no value'}" for part in parts]
    known = left.value is not None and right.value is not None and _has(left) and _has(right)
    true = known and holds(float(left.value or 0.0), float(right.value or 0.0))
    return Condition(text, bool(true), "; ".join(told), parts)


def _has(part: Measured) -> bool:
    return part.value is not None and not math.isnan(part.value)


@dataclass(frozen=True)
class Finding(Notice):
    """A conclusion; if one of its conditions fails, a warning replaces it.

    Attributes:
        conditions: Conditions under which its sentences are true.
        claim: Its title as it was written.
        sentences: Its text as it was written.
    """

    conditions: tuple[Condition, ...] = ()
    claim: str = ""
    sentences: str = ""

    @property
    def holds(self) -> bool:
        """True if all conditions hold."""
        return all(condition.holds for condition in self.conditions)


ANSWERS: tuple[NoticeKind, ...] = ("stands", "falls", "turns", "why")
"""Kinds of answers: the source is right, is wrong, is right only under other conditions, and the reason."""


def finding(title: str, text: str, *holds: Condition, kind: NoticeKind = "finding") -> Finding:
    """Return a conclusion that says so itself when it is no longer true.

    There is one branch of prose: sentences that are chosen by the numbers contradict each other sooner or later.

    Args:
        title: What was found, in a line.
        text: The sentences; inline mathematics as in Text.
        holds: The conditions under which each of the sentences is true, with a margin.
        kind: "finding", or one of ANSWERS.

    Raises:
        ValueError: if `holds` is empty.
    """
    if not holds:
        raise ValueError(f"finding '{title}': needs one condition or more; what nothing can refute concludes nothing")
    failed, answer = [condition for condition in holds if not condition.holds], kind in ANSWERS
    if not failed:
        return Finding(kind, title, text, answer, holds, title, text)
    reasons = " ".join(f"Not so: {condition.text} ({condition.measured})." for condition in failed)
    written = f"{reasons} It was written: {text}" if text else reasons
    return Finding("warning", f"No longer holds: {title}", written, answer, holds, title, text)


def findings(document: Document) -> Iterator[tuple[str, Finding]]:
    """Yield the conclusions of a report in reading order, each with the number of its section."""
    for chapter in chapters(document):
        for block in chapter.section.blocks:
            if isinstance(block, Finding):
                yield chapter.number, block
