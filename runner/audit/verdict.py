"""The verdict on an entry, worked out: its forms against the truth at every sample."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from runner.audit.entry import Entry, Form, Part
from runner.audit.evaluation import evaluate
from runner.audit.expressions import ExpressionError, parse
from runner.audit.sources import truth_of
from runner.audit.truth import Elements, FloatArray, Symbols, Truth

SAMPLES = 1000
Verdict = Literal["correct", "correct after repair", "wrong as printed", "unreadable", "definition"]
VERDICTS: tuple[Verdict, ...] = (
    "correct",
    "correct after repair",
    "wrong as printed",
    "unreadable",
    "definition",
)


class AuditError(Exception):
    """An entry that contradicts itself: a correction that is wrong, two truths that disagree. A fault of ours."""


@dataclass(frozen=True)
class Measured:
    """How far a form is from the truth.

    Attributes:
        largest: Largest error over the samples and elements.
        typical: Median over the samples of the largest error of an element.
        elements: Largest error of each element, by name.
    """

    largest: float
    typical: float
    elements: Mapping[str, float]


@dataclass(frozen=True)
class Judged:
    """An entry with its verdict.

    Attributes:
        source: The work.
        entry: The equation.
        verdict: What the samples say.
        measured: Error of the form as printed (after repair where there is one); None where it has none.
        second: The same against the second way to the truth.
        unread: Why the printed form cannot be read, or "".
    """

    source: str
    entry: Entry
    verdict: Verdict
    measured: Measured | None
    second: Measured | None
    unread: str


class Judge:
    """The verdicts on the entries of one part, all on the same samples.

    Args:
        part: The data file.
        samples: How many configurations are drawn.
    """

    def __init__(self, part: Part, samples: int = SAMPLES) -> None:
        self._part, self._samples = part, samples
        self._truths: dict[tuple[str, int], Elements] = {}

    @cached_property
    def symbols(self) -> Symbols:
        """The sample: a value of each symbol at each configuration."""
        return _draw(self._part.source, self._part.symbols, self._samples)

    def judge(self, entry: Entry) -> Judged:
        """Return the verdict on an entry.

        Raises:
            AuditError: If the entry contradicts itself.
        """
        unread = _unread(entry.printed)
        if unread:
            return self._after_repair(entry, unread)
        if not entry.truth:
            return self._judged(entry, "definition", None)
        measured = self._measure(entry, entry.printed)
        if entry.repair is not None:
            if max(each.largest for each in measured) <= entry.tolerance:
                raise AuditError(f"{entry.id}: is repaired, but holds as it stands")
            return self._after_repair(entry, "")
        if max(each.largest for each in measured) <= entry.tolerance:
            return self._judged(entry, "correct", measured)
        return self._wrong(entry, measured, "")

    def _after_repair(self, entry: Entry, unread: str) -> Judged:
        if entry.repair is None:
            return self._judged(entry, "unreadable", None, unread)
        measured = self._measure(entry, entry.repair)
        if max(each.largest for each in measured) <= entry.tolerance:
            return self._judged(entry, "correct after repair", measured, unread)
        return self._wrong(entry, measured, unread)

    def _wrong(self, entry: Entry, measured: tuple[Measured, Measured], unread: str) -> Judged:
        if min(each.largest for each in measured) <= entry.tolerance:
            raise AuditError(f"{entry.id}: the two ways to the truth disagree")
        if entry.corrected is None:
            raise AuditError(f"{entry.id}: is wrong by {measured[0].largest:.3g} {entry.unit} and has no correction")
        right = self._measure(entry, entry.corrected)
        if max(each.largest for each in right) > entry.tolerance:
            raise AuditError(f"{entry.id}: the correction is wrong by {right[0].largest:.3g} {entry.unit}")
        return self._judged(entry, "wrong as printed", measured, unread)

    def _judged(
        self, entry: Entry, verdict: Verdict, measured: tuple[Measured, Measured] | None, unread: str = ""
    ) -> Judged:
        if entry.corrected is not None and verdict != "wrong as printed":
            raise AuditError(f"{entry.id}: is corrected, but its verdict is '{verdict}'")
        first, second = measured or (None, None)
        return Judged(self._part.source, entry, verdict, first, second, unread)

    def _measure(self, entry: Entry, form: Form) -> tuple[Measured, Measured]:
        found = self._evaluate(form)
        first, second = (_compare(entry, found, self._truth(entry.truth, way)) for way in (0, 1))
        return first, second

    def _evaluate(self, form: Form) -> Elements:
        if form.code:
            values: Elements = truth_of(self._part.source, form.code)(self.symbols)
            return values
        try:
            return {name: evaluate(parse(text), self.symbols) for name, text in form.elements.items()}
        except ExpressionError as error:
            raise AuditError(f"{self._part.source}: {error}") from error

    def _truth(self, name: str, way: int) -> Elements:
        if (name, way) not in self._truths:
            truth: Truth = truth_of(self._part.source, name)
            self._truths[name, way] = (truth.first, truth.second)[way](self.symbols)
        return self._truths[name, way]


def _unread(form: Form) -> str:
    """Return why a form cannot be read, or "" when it can."""
    try:
        for text in form.elements.values():
            parse(text)
    except ExpressionError as error:
        return error.reason
    return ""


@lru_cache(maxsize=8)
def _draw(source: str, name: str, samples: int) -> Symbols:
    symbols: Symbols = truth_of(source, name)(samples, np.random.default_rng(0))
    return symbols


def _compare(entry: Entry, found: Elements, truth: Elements) -> Measured:
    missing = sorted(set(found) - set(truth))
    if missing:
        raise AuditError(f"{entry.id}: no truth for {', '.join(missing)}; there is {', '.join(truth)}")
    sizes = {name: error(values, truth[name], entry.unit) for name, values in found.items()}
    worst = np.max(list(sizes.values()), axis=0)
    return Measured(
        float(worst.max()), float(np.median(worst)), {name: float(size.max()) for name, size in sizes.items()}
    )


def error(found: FloatArray, truth: FloatArray, unit: str) -> FloatArray:
    """Return how far an element is from the truth at each sample, shape (T,); infinite where it is no number.

    Args:
        found: The element, shape (T,) or (T, ...): the largest difference of a matrix counts.
        truth: What it should be.
        unit: Its unit; a difference in "rad" is taken the short way round.
    """
    difference = found - truth
    if unit == "rad":
        difference = (difference + np.pi) % (2 * np.pi) - np.pi
    size = np.abs(difference).reshape(len(difference), -1).max(axis=1)
    return np.where(np.isfinite(size), size, np.inf)
