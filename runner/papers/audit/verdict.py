"""Verdicts on audit entries: printed, emended and corrected forms compared with both derivations."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple, get_args

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.data_file import line_of
from runner.base.errors import ConfigError, RunnerError, nearest
from runner.base.quantities import quantity
from runner.papers.audit.derivations import Derivations, Elements, Symbols
from runner.papers.audit.entry import Entry, Form, SourceFile, form_values, left_side, right_elements
from runner.papers.audit.evaluation import Numbered, SampleValues, evaluate, evaluate_all, size_of
from runner.papers.audit.model_derivations import AuditedArm, audited_arm, sample
from runner.papers.audit.sources import Source, derivation_of
from runner.papers.expressions.parser import parse
from runner.papers.expressions.tree import Name, at_places
from runner.papers.expressions.tree import symbols as symbols_in
from runner.papers.expressions.typesetting import Letters

SAMPLES = 1000
Verdict = Literal["correct", "correct after emendation", "wrong as printed", "unreadable", "definition"]
_FILL = re.compile(r"\{(\w+)\}")
_Sides = tuple[str, Mapping[str, int], list[FloatArray]]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)


class AuditError(RunnerError):
    """An entry that contradicts itself or names what does not exist: a fault of those who audit."""


@dataclass(frozen=True)
class FormErrors:
    """Errors of a form against the true values.

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
class CheckedEquation:
    """An entry with its verdict.

    Attributes:
        source: Name of the study.
        entry: The equation.
        verdict: What the samples say.
        measured: Error of the form as printed (after emendation where there is one); None where it has none.
        second: The same against the second derivation.
        methods: The methods of its two derivations; empty strings if it claims nothing.
        letters: Names as the source writes them, in Typst mathematics.
    """

    source: str
    entry: Entry
    verdict: Verdict
    measured: FormErrors | None
    second: FormErrors | None
    methods: tuple[str, str]
    letters: Letters = field(default_factory=dict)


class Check:
    """The verdicts on the entries of one part, all on the same samples.

    Args:
        part: The data file.
        samples: How many configurations are drawn.
    """

    def __init__(self, part: SourceFile, samples: int = SAMPLES) -> None:
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

    def check(self, entry: Entry) -> CheckedEquation:
        """Return the verdict on an entry.

        Raises:
            AuditError: If the entry contradicts itself, or names what does not exist; with file and entry.
        """
        try:
            return self._check(entry.as_read(self._part.source))
        except RunnerError as error:
            what = "; ".join(error.problems) if isinstance(error, ConfigError) else error
            raise AuditError(
                f"{self._part.path}, line {line_of(self._part.path, f'id: {entry.id}')}: {entry.id}: {what}"
            ) from error

    def _check(self, entry: Entry) -> CheckedEquation:
        unread = not entry.printed.readable or bool(entry.emendation and entry.printed.math and not entry.printed.code)
        if unread and entry.emendation is None:
            return self._checked(entry, "unreadable", None)
        if not (unread or entry.derivation):
            return self._checked(entry, "definition", None)
        printed = None if unread else self._measure(entry, entry.printed)
        if entry.emendation and printed and printed.worst <= entry.tolerance:
            raise AuditError("is emended, but holds as printed")
        entry = entry.model_copy(update={"finding": _filled(entry, printed)})
        measured = (
            self._measure(entry, entry.emendation or entry.printed) if entry.emendation or printed is None else printed
        )
        if measured.worst <= entry.tolerance:
            return self._checked(entry, "correct after emendation" if entry.emendation else "correct", measured)
        if min(measured.first.largest, measured.second.largest) <= entry.tolerance:
            raise AuditError("its two derivations disagree")
        if entry.corrected is None:
            raise AuditError(f"is wrong by {measured.first.largest:.3g} {entry.unit} and has no correction")
        right = self._measure(entry, entry.corrected)
        if right.worst > entry.tolerance:
            raise AuditError(f"the correction is wrong by {right.first.largest:.3g} {entry.unit}")
        return self._checked(entry, "wrong as printed", measured)

    def _checked(self, entry: Entry, verdict: Verdict, found: "_Both | None") -> CheckedEquation:
        if entry.corrected is not None and verdict != "wrong as printed":
            raise AuditError(f"is corrected, but its verdict is '{verdict}'")
        first, second = (found.first, found.second) if found else (None, None)
        methods = self.derivations(entry).methods if entry.derivation else ("", "")
        return CheckedEquation(
            self._part.source.name, entry, verdict, first, second, methods, {**self._part.letters, **entry.letters}
        )

    def _measure(self, entry: Entry, form: Form) -> "_Both":
        sides, derivations = self._sides(entry, form), self.derivations(entry)
        for which, function in enumerate((derivations.first, derivations.second)):
            if (entry.derivation, entry.tip, which) not in self._found:
                self._found[entry.derivation, entry.tip, which] = function(self.symbols)
        return _Both(
            *(self._compare(entry, sides, self._found[entry.derivation, entry.tip, which]) for which in (0, 1))
        )

    def _sides(self, entry: Entry, form: Form) -> list[_Sides]:
        if form.code:
            found: Elements = derivation_of(self._part.source, form.code)(self.symbols)
            return [(name, {}, [values]) for name, values in found.items()]
        values, sides = form_values(entry, form, self.symbols, self._right), []
        for left, right in entry.equations(form):
            sides.append((left, right.numbers, values.sides(at_places(left, right.numbers), right)))
        # Those that others use are intermediate steps.
        return [each for each in sides if at_places(each[0], each[1]) not in values.used]

    def _compare(self, entry: Entry, sides: list[_Sides], true_values: Elements) -> FormErrors:
        sizes: dict[str, FloatArray] = {}
        true_size = 0.0
        for name, numbers, values in sides:
            true, placed = self._left(name, numbers, true_values), at_places(name, numbers)
            for each in values:
                if each.ndim > 1 and each.shape != true.shape:
                    raise AuditError(f"{placed} is {size_of(each)}; its true value is {size_of(true)}")
            size = np.max([error(each, true, entry.unit) for each in values], axis=0)
            true_size = max(true_size, float(np.abs(true).max()))
            sizes[placed] = np.maximum(size, sizes.get(placed, 0.0))
        worst = np.max(list(sizes.values()), axis=0)
        largest = {name: float(size.max()) for name, size in sizes.items()}
        return FormErrors(float(worst.max()), float(np.median(worst)), largest, true_size)

    def _left(self, name: str, numbers: Mapping[str, int], true_values: Elements) -> FloatArray:
        """Return the true values of a left side."""
        if (placed := at_places(name, numbers)) in true_values:
            return true_values[placed]
        node = left_side(name)
        if isinstance(node, Name) or not any(at_places(each, numbers) in true_values for each in symbols_in(node)):
            raise AuditError(f"no true value of {placed}; there is {', '.join(true_values)}")
        return evaluate(parse(name), SampleValues({**self.symbols, **true_values}, self._right), numbers)

    def derivations(self, entry: Entry) -> Derivations:
        """Return the reference derivations of an entry."""
        if entry.derivation.startswith("model."):
            return self._arm.at(entry.tip).derivations(entry.derivation)
        found: Derivations = derivation_of(self._part.source, entry.derivation)
        return found


class _Both(NamedTuple):
    """A form against both derivations."""

    first: FormErrors
    second: FormErrors

    @property
    def worst(self) -> float:
        return max(each.largest for each in self)


def _filled(entry: Entry, printed: _Both | None) -> str:
    """Return the finding of an entry with the values that were measured."""
    measured = printed.first if printed else FormErrors(0.0, 0.0, {})
    values = {"largest": measured.largest, "typical": measured.typical, "size": measured.size}

    def value(match: re.Match[str]) -> str:
        if printed is None or match[1] not in values:
            told = f"finding: no value '{match[1]}'{nearest(match[1], tuple(values))}"
            raise AuditError(f"{told}; allowed, if the printed form can be evaluated: {', '.join(values)}")
        return quantity(values[match[1]], entry.unit)

    return _FILL.sub(value, entry.finding)


@lru_cache(maxsize=8)
def _draw(source: Source, name: str, samples: int) -> Symbols:
    symbols: Symbols = derivation_of(source, name)(samples, np.random.default_rng(0))
    return symbols


def error(found: FloatArray, true: FloatArray, unit: str) -> FloatArray:
    """Return the error of an element at each sample, shape (T,); infinite if it is not a finite number.

    Args:
        found: The element, shape (T,) or (T, ...): the largest difference of a matrix counts, and 0 is a matrix of 0.
        true: What it should be.
        unit: Its unit; a difference in "rad" is taken the short way round.
    """
    numbers = found.reshape(len(found), *(1,) * (true.ndim - 1)) if found.ndim == 1 else found
    difference = numbers - true
    if unit == "rad":
        difference = (difference + np.pi) % (2 * np.pi) - np.pi
    size = np.abs(difference).reshape(len(difference), -1).max(axis=1)
    return np.where(np.isfinite(size), size, np.inf)
