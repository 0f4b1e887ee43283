"""Verdicts on audit entries: printed, repaired and corrected forms compared with the truth."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple, get_args

import numpy as np

from runner.audit.entry import Entry, Form, Part, form_values, left_side, right_elements
from runner.audit.evaluation import Numbered, Values, evaluate, evaluate_all
from runner.audit.model_truths import AuditedArm, audited_arm, sample
from runner.audit.sources import Source, truth_of
from runner.audit.truth import Elements, Symbols, Truth
from runner.base.arrays import FloatArray
from runner.base.data_file import line_of
from runner.base.errors import ConfigError, RunnerError, nearest
from runner.base.expressions.parser import parse
from runner.base.expressions.tree import Name, at_places
from runner.base.expressions.tree import symbols as symbols_in
from runner.base.expressions.typesetting import Letters
from runner.base.quantities import quantity

SAMPLES = 1000
Verdict = Literal["correct", "correct after repair", "wrong as printed", "unreadable", "definition"]
_FILL = re.compile(r"\{(\w+)\}")
_Sides = tuple[str, Mapping[str, int], list[FloatArray]]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)


class AuditError(RunnerError):
    """An entry that contradicts itself or names what does not exist: a fault of those who audit."""


@dataclass(frozen=True)
class Measured:
    """How far a form is from the truth.

    Attributes:
        largest: Largest error over the samples and elements.
        typical: Median over the samples of the largest error of an element.
        elements: Largest error of each element, by name.
        size: Largest true value.
    """

    largest: float
    typical: float
    elements: Mapping[str, float]
    size: float = 0.0


@dataclass(frozen=True)
class Judged:
    """An entry with its verdict.

    Attributes:
        source: Name of the study.
        entry: The equation.
        verdict: What the samples say.
        measured: Error of the form as printed (after repair where there is one); None where it has none.
        second: The same against the second way to the truth.
        ways: The two ways to what it claims to equal, in words; empty texts where it claims nothing.
        letters: Names as the source writes them, in Typst mathematics.
    """

    source: str
    entry: Entry
    verdict: Verdict
    measured: Measured | None
    second: Measured | None
    ways: tuple[str, str]
    letters: Letters = field(default_factory=dict)


class Judge:
    """The verdicts on the entries of one part, all on the same samples.

    Args:
        part: The data file.
        samples: How many configurations are drawn.
    """

    def __init__(self, part: Part, samples: int = SAMPLES) -> None:
        self._part, self._samples = part, samples
        self._found: dict[tuple[str, str, int], Elements] = {}

    @cached_property
    def symbols(self) -> Symbols:
        """The sample: a value of each symbol at each configuration."""
        part = self._part
        if isinstance(part.symbols, str):
            return _draw(part.source, part.symbols, self._samples)
        arm = self._arm
        return evaluate_all(part.symbols, sample(arm.model, arm.joints, self._samples, np.random.default_rng(0)))

    @cached_property
    def _right(self) -> dict[str, Numbered]:
        return right_elements(self._part)

    @cached_property
    def _arm(self) -> AuditedArm:
        return audited_arm(self._part.robot, self._part.tip, self._part.joints, self._part.source.folder)

    def judge(self, entry: Entry) -> Judged:
        """Return the verdict on an entry.

        Raises:
            AuditError: If the entry contradicts itself, or names what does not exist; tells file and entry.
        """
        try:
            return self._judge(entry.as_read(self._part.source))
        except RunnerError as error:
            what = "; ".join(error.problems) if isinstance(error, ConfigError) else error
            raise AuditError(
                f"{self._part.path}, line {line_of(self._part.path, f'id: {entry.id}')}: {entry.id}: {what}"
            ) from error

    def _judge(self, entry: Entry) -> Judged:
        unread = not entry.printed.readable or bool(entry.repair and entry.printed.math and not entry.printed.code)
        if unread and entry.repair is None:
            return self._judged(entry, "unreadable", None)
        if not (unread or entry.truth):
            return self._judged(entry, "definition", None)
        printed = None if unread else self._measure(entry, entry.printed)
        if entry.repair and printed and printed.worst <= entry.tolerance:
            raise AuditError("is repaired, but holds as it stands")
        entry = entry.model_copy(update={"finding": _filled(entry, printed)})
        measured = self._measure(entry, entry.repair or entry.printed) if entry.repair or printed is None else printed
        if measured.worst <= entry.tolerance:
            return self._judged(entry, "correct after repair" if entry.repair else "correct", measured)
        if min(measured.first.largest, measured.second.largest) <= entry.tolerance:
            raise AuditError("the two ways to the truth disagree")
        if entry.corrected is None:
            raise AuditError(f"is wrong by {measured.first.largest:.3g} {entry.unit} and has no correction")
        right = self._measure(entry, entry.corrected)
        if right.worst > entry.tolerance:
            raise AuditError(f"the correction is wrong by {right.first.largest:.3g} {entry.unit}")
        return self._judged(entry, "wrong as printed", measured)

    def _judged(self, entry: Entry, verdict: Verdict, found: "_Both | None") -> Judged:
        if entry.corrected is not None and verdict != "wrong as printed":
            raise AuditError(f"is corrected, but its verdict is '{verdict}'")
        first, second = (found.first, found.second) if found else (None, None)
        ways = self.truth(entry).ways if entry.truth else ("", "")
        return Judged(
            self._part.source.name, entry, verdict, first, second, ways, {**self._part.letters, **entry.letters}
        )

    def _measure(self, entry: Entry, form: Form) -> "_Both":
        sides, truth = self._sides(entry, form), self.truth(entry)
        for way, function in enumerate((truth.first, truth.second)):
            if (entry.truth, entry.tip, way) not in self._found:
                self._found[entry.truth, entry.tip, way] = function(self.symbols)
        return _Both(*(self._compare(entry, sides, self._found[entry.truth, entry.tip, way]) for way in (0, 1)))

    def _sides(self, entry: Entry, form: Form) -> list[_Sides]:
        if form.code:
            found: Elements = truth_of(self._part.source, form.code)(self.symbols)
            return [(name, {}, [values]) for name, values in found.items()]
        values, sides = form_values(entry, form, self.symbols, self._right), []
        for left, right in entry.equations(form):
            sides.append((left, right.numbers, values.sides(at_places(left, right.numbers), right)))
        # Those that others use are steps on the way.
        return [each for each in sides if at_places(each[0], each[1]) not in values.used]

    def _compare(self, entry: Entry, sides: list[_Sides], truth: Elements) -> Measured:
        sizes: dict[str, FloatArray] = {}
        true_size = 0.0
        for name, numbers, values in sides:
            true, placed = self._left(name, numbers, truth), at_places(name, numbers)
            size = np.max([error(each, true, entry.unit) for each in values], axis=0)
            true_size = max(true_size, float(np.abs(true).max()))
            sizes[placed] = np.maximum(size, sizes.get(placed, 0.0))
        worst = np.max(list(sizes.values()), axis=0)
        largest = {name: float(size.max()) for name, size in sizes.items()}
        return Measured(float(worst.max()), float(np.median(worst)), largest, true_size)

    def _left(self, name: str, numbers: Mapping[str, int], truth: Elements) -> FloatArray:
        """Return the true values of a left side."""
        if (placed := at_places(name, numbers)) in truth:
            return truth[placed]
        node = left_side(name)
        if isinstance(node, Name) or not any(at_places(each, numbers) in truth for each in symbols_in(node)):
            raise AuditError(f"no truth for {placed}; there is {', '.join(truth)}")
        return evaluate(parse(name), Values({**self.symbols, **truth}, self._right), numbers)

    def truth(self, entry: Entry) -> Truth:
        """Return what an entry claims to equal."""
        if entry.truth.startswith("model."):
            return self._arm.at(entry.tip).truth(entry.truth)
        truth: Truth = truth_of(self._part.source, entry.truth)
        return truth


class _Both(NamedTuple):
    """A form against both ways to the truth."""

    first: Measured
    second: Measured

    @property
    def worst(self) -> float:
        return max(each.largest for each in self)


def _filled(entry: Entry, printed: _Both | None) -> str:
    """Return the finding of an entry with the values that were measured."""
    measured = printed.first if printed else Measured(0.0, 0.0, {})
    values = {"largest": measured.largest, "typical": measured.typical, "size": measured.size}

    def value(match: re.Match[str]) -> str:
        if printed is None or match[1] not in values:
            told = f"finding: no value '{match[1]}'{nearest(match[1], tuple(values))}"
            raise AuditError(f"{told}; allowed, if the printed form can be evaluated: {', '.join(values)}")
        return quantity(values[match[1]], entry.unit)

    return _FILL.sub(value, entry.finding)


@lru_cache(maxsize=8)
def _draw(source: Source, name: str, samples: int) -> Symbols:
    symbols: Symbols = truth_of(source, name)(samples, np.random.default_rng(0))
    return symbols


def error(found: FloatArray, truth: FloatArray, unit: str) -> FloatArray:
    """Return how far an element is from the truth at each sample, shape (T,); infinite where it is no number.

    Args:
        found: The element, shape (T,) or (T, ...): the largest difference of a matrix counts, and 0 is a matrix of 0.
        truth: What it should be.
        unit: Its unit; a difference in "rad" is taken the short way round.
    """
    numbers = found.reshape(len(found), *(1,) * (truth.ndim - 1)) if found.ndim == 1 else found
    difference = numbers - truth
    if unit == "rad":
        difference = (difference + np.pi) % (2 * np.pi) - np.pi
    size = np.abs(difference).reshape(len(difference), -1).max(axis=1)
    return np.where(np.isfinite(size), size, np.inf)
