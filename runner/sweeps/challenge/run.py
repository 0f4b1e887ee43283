"""Execution of a challenge: the asked case on fresh seeds, its variations in looks, and turning values."""

import contextlib
import math
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TypeVar

import numpy as np

from runner import store
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, RunnerError
from runner.base.quantities import ROUNDING
from runner.config.compose.composer import Composer
from runner.statistics.conclusion import ALPHA, larger_median
from runner.statistics.paired import PairedComparison
from runner.statistics.scope import (
    LOOKS,
    AskedEffect,
    JudgedVariation,
    TriedVariation,
    came_back,
    first_pairs,
    judge,
    judge_in_looks,
    pairs_of_looks,
)
from runner.statistics.turning import PAIRS, POINTS, Turn, find_turns
from runner.store.drawn import draws_nothing
from runner.store.kinds import note
from runner.store.seal import DamagedError
from runner.sweeps.at_work import at_work
from runner.sweeps.challenge.bench import PairBench
from runner.sweeps.challenge.budget import ChallengeBudget
from runner.sweeps.challenge.case import Case, check_case
from runner.sweeps.challenge.changed import Changed, changed_keys
from runner.sweeps.challenge.combinations import Combination, combine
from runner.sweeps.challenge.drawn import Drawn, compare_drawn
from runner.sweeps.challenge.families import Family, NotApplicableError, SidesChange, family_of
from runner.sweeps.challenge.question import LeftOutVariation, Question, Value, Variation
from runner.sweeps.challenge.stored import AnsweredVariation, Challenge, Turning, open_challenge, place_of
from runner.sweeps.challenge.table import list_variations
from runner.sweeps.job import check_job
from runner.sweeps.run import Engine

_Checked = TypeVar("_Checked", Variation, Combination)
_ENDS = ("reversed", "vanishes")
_AT_ONCE = 4  # variations between two looks at the clock


def challenge(
    question: Question,
    values: dict[str, list[Value]],
    outputs: Path,
    engine: Engine,
    command: str,
    budget: ChallengeBudget,
) -> Challenge:
    """Execute the missing runs of a challenge and store it.

    The question and the list of variations are stored before the first run.

    Args:
        question: The question.
        values: Values of each family.
        outputs: The outputs folder.
        engine: Location of the execution.
        command: Command that makes or continues it.
        budget: What it may cost.

    Raises:
        ConfigError: if the asked case can no longer be composed.
        RunnerError: if the budget is too small for one variation, or no variation applies.
        TemporaryError: if a run cannot be written, or a worker fails.
    """
    began = time.monotonic()
    composer = Composer(question.config_dirs)
    case = check_case(question, composer)
    variations, left = list_variations(case, values)
    keys = changed_keys([text for one in variations for text in chain(*one.sides)])
    cells = [(side, tuple(more)) for one in variations for side, more in enumerate(one.sides)]
    plan = Changed(case, cells, keys, (), composer)
    kept = []
    for place, one in enumerate(variations):
        try:
            kept.append(AnsweredVariation(_checked(plan, place, one)))
        except ConfigError as error:
            left.append(LeftOutVariation(one.family, one.value, error.problems[0], one.kind, True))
    combined = list(_combine([one.variation for one in kept], question.seed, case, composer))
    if not kept:
        raise RunnerError("challenge: no variation applies. Allowed: --vary KEY=A,B.")
    store.prepare(outputs)
    folder = place_of(outputs, question, kept, left)
    made = Challenge(folder, question, kept, left, command, combined=combined, budget=budget.text)
    with at_work(folder, exclusive=True) as name:
        keys = changed_keys([*keys, "seed=", "repetitions="])
        bench = PairBench(case, question, composer, keys, folder, outputs, engine, name)
        has_ended = _has_ended(made)
        if not has_ended:
            made.write(bench.jobs)
        note(folder)
        bench.end = math.inf if budget.seconds is None else began + budget.seconds
        try:
            made = replace(_Runner(case, made, bench, budget).run(), ended=True, seconds=time.monotonic() - began)
        finally:
            if made.ended or not has_ended:  # an interruption keeps the words of an earlier command
                made.write(bench.jobs)
    return open_challenge(folder)


def _has_ended(made: Challenge) -> bool:
    """Return True if an earlier command has ended the challenge."""
    try:
        return made.is_stored and open_challenge(made.folder).ended
    except DamagedError:
        return False


def _checked(plan: Changed, place: int, changed: _Checked) -> _Checked:
    """Return a variation or combination that can be simulated, with the knowledge if anything is drawn.

    Raises:
        ConfigError: if it cannot be simulated.
    """
    composed = [plan.composed(cell) for cell in (2 * place, 2 * place + 1)]
    for one in composed:
        check_job(one)
    return replace(changed, exact=all(draws_nothing(one.resolved) for one in composed))


def _combine(variations: Sequence[Variation], seed: int, case: Case, composer: Composer) -> Iterator[Combination]:
    """Yield the combinations that can be simulated, with the knowledge if anything is drawn."""
    combined = list(combine(variations, seed))
    keys = changed_keys([text for one in variations for text in chain(*one.sides)])
    cells = [(side, tuple(more)) for one in combined for side, more in enumerate(one.sides)]
    plan = Changed(case, cells, keys, (), composer)
    for place, one in enumerate(combined):
        with contextlib.suppress(ConfigError):
            yield _checked(plan, place, one)


class _Runner:
    """The parts of a challenge, in the order of the budget."""

    def __init__(self, case: Case, made: Challenge, bench: PairBench, budget: ChallengeBudget) -> None:
        self._case, self._made, self._bench, self._budget = case, made, bench, budget
        self._question = made.question
        self._tried: dict[int, TriedVariation] = {}

    def run(self) -> Challenge:
        """Return the challenge with all words that the budget allows."""
        made = self._ask_again()
        if not made.came_back:
            return made
        asked = self._asked(made)
        judged = judge_in_looks(self._ask, len(made.found[: self._budget.variations]), asked)
        if not judged:
            raise RunnerError(
                f"--budget: too small for one variation ({self._budget.text}). Allowed: more time, or none."
            )
        found = [self._described(place, judged) for place in range(len(made.found))]
        made = replace(made, found=found)
        made = replace(made, turnings=self._turnings(made, asked))
        made = replace(made, combined=self._described_together(made, asked))
        self._keep_traces(made)
        return made

    def _ask_again(self) -> Challenge:
        """Return the challenge with the asked case on fresh seeds, in looks until the stored answer comes back."""
        question = self._question
        exact = all(draws_nothing(config.resolved) for config in self._case.configs)
        asked_case = Variation("numbers", "seeds", "fresh", "fresh seeds", ((), ()), exact=exact)
        back = False
        for pairs in pairs_of_looks(self._first):
            _tell(f"the asked case on fresh seeds, {pairs} pairs")
            one = next(iter(self._compare([asked_case], pairs)), None)
            if one is None:
                raise RunnerError(f"--budget: too small for the asked case ({self._budget.text}). Allowed: more time.")
            found = one.comparison
            if found is None:
                raise RunnerError(f"challenge: the asked case cannot be asked again: {one.reason}.")
            self._scale = _scale(found)
            asked = AskedEffect(question.sign, 0.0, self._scale, question.is_fraction)
            (fresh,) = judge([one], replace(asked, size=_finite(found.difference / asked.of(found))), ALPHA)
            level = ALPHA / LOOKS if question.sign else ALPHA
            back = came_back(found, question.sign, level, question.is_fraction) is not None
            if back or not question.sign or found.exact:
                break
        return replace(self._made, fresh=fresh, came_back=back)

    def _asked(self, made: Challenge) -> AskedEffect:
        size = _finite(made.fresh.effect) if made.fresh and made.fresh.effect is not None else 0.0
        return AskedEffect(self._question.sign, size, self._scale, self._question.is_fraction)

    @property
    def _first(self) -> int:
        count = len(self._made.found) if self._budget.variations is None else self._budget.variations
        return first_pairs(min(count, len(self._made.found)))

    def _ask(self, places: Sequence[int], pairs: int) -> list[TriedVariation]:
        """Return some variations with a number of pairs; fewer if the time is over."""
        _tell(f"{len(places)} variation{'s' if len(places) > 1 else ''}, {pairs} pairs each")
        chosen = [self._made.found[place].variation for place in places]
        at_once = len(chosen) if self._budget.seconds is None else _AT_ONCE
        tried: list[TriedVariation] = []
        for start in range(0, len(chosen), at_once):
            tried += self._compare(chosen[start : start + at_once], pairs)
        self._tried.update(zip(places, tried, strict=False))
        return tried

    def _compare(self, variations: Sequence[Variation], pairs: int) -> list[TriedVariation]:
        draws = self._bench.draw(variations, self._first, pairs // self._first)
        errors = [self._question.error if one.family != "step" else None for one in variations]
        return [compare_drawn(a, b, error) for (a, b), error in zip(draws, errors, strict=False)]

    def _described(self, place: int, judged: Sequence[JudgedVariation]) -> AnsweredVariation:
        found = self._made.found[place]
        if place >= len(judged):
            return found
        tried = self._tried[place]
        medians = tried.comparison.medians if tried.comparison else None
        hashes = self._bench.names_of(found.variation)
        return AnsweredVariation(found.variation, judged[place], medians, hashes, tried.reason)

    def _turnings(self, made: Challenge, asked: AskedEffect) -> list[Turning]:
        found = []
        ends = _ends(made)
        if ends:
            _tell(f"turning values towards {len(ends)} variation{'s' if len(ends) > 1 else ''}")
        self._draw_points(ends)
        for place in ends:
            turning = self._turning(made, place, asked)
            if turning is not None:
                found.append(turning)
        return found

    def _turning(self, made: Challenge, place: int, asked: AskedEffect) -> Turning | None:
        """Return the turning values between the asked case and a variation; None if the time is over."""
        variation = made.found[place].variation
        family = family_of(variation)
        if family is None or family.neutral is None:
            return None
        points, allowed = self._points(variation, family)
        end = float(variation.value)
        vanished: dict[float, bool] = {}

        def ask(values: Sequence[float]) -> list[FloatArray]:
            changes: list[SidesChange] = []
            try:
                for value in values:
                    changes.append(replace(family.change(self._case, value), exact=variation.exact))
                draws = self._bench.draw(changes, PAIRS, 1, self._bench.turning_block)
            except (NotApplicableError, ConfigError):  # a value between two that can be simulated cannot
                return []
            tried = [compare_drawn(a, b, self._question.error) for a, b in draws]
            for value, one in zip(values, tried, strict=False):
                (judged,) = judge([one], asked, ALPHA)
                vanished[value] = judged.word == "vanishes"
            return [_differences(a, b) for a, b in draws]

        turns = find_turns(ask, points, allowed)
        if len(vanished) < 2:
            return None
        values = [turn.between[1] if turn.between else _rounded(turn) for turn in turns]
        labels = [family.change(self._case, value).label for value in values]
        ordered = sorted(vanished, key=lambda value: abs(value - end))
        run = next((number for number, value in enumerate(ordered) if not vanished[value]), len(ordered))
        first = ordered[run - 1] if run and not turns else None
        label = "" if first is None else family.change(self._case, first).label
        return Turning(place, turns, labels, first, label)

    def _points(self, variation: Variation, family: Family) -> tuple[list[float], list[float] | None]:
        """Return the first points between the asked value and that of a variation, and the allowed values, ascending.

        The allowed values are None for a continuous choice.
        """
        neutral, end = family.neutral or 0.0, float(variation.value)
        points, allowed = np.linspace(min(neutral, end), max(neutral, end), POINTS).tolist(), None
        if family.discrete is not None:
            count = round(abs(end - neutral) / family.discrete(self._case))
            allowed = np.linspace(points[0], points[-1], count + 1).tolist()
        return points, allowed

    def _described_together(self, made: Challenge, asked: AskedEffect) -> list[Combination]:
        """Return the combinations with their effects; the budget may cut them."""
        most = self._budget.variations
        count = len(made.combined) if most is None else max(0, most - len(made.found))
        found = list(made.combined)
        if count and not self._bench.is_over:
            _tell(f"{min(count, len(found))} combinations")
        for start in range(0, min(count, len(found)), _AT_ONCE):
            some = found[start : min(start + _AT_ONCE, count)]
            draws = self._bench.draw(some, self._first, 1)
            for place, (a, b) in enumerate(draws, start):
                tried = compare_drawn(a, b, self._question.error)
                (judged,) = judge([tried], asked, ALPHA)
                works = judged.word not in ("neither works", "only one works", "cannot be asked")
                found[place] = replace(found[place], pairs=len(a.values), effect=judged.effect if works else None)
        return found

    def _draw_points(self, places: Sequence[int]) -> None:
        """Simulate the first points of all continuous choices together."""
        changes: list[SidesChange] = []
        for variation in (self._made.found[place].variation for place in places):
            family = family_of(variation)
            if family is None or family.neutral is None or family.discrete is not None:
                continue
            with contextlib.suppress(NotApplicableError):
                changes += [replace(family.change(self._case, value), exact=variation.exact)
                            for value in self._points(variation, family)[0]]  # fmt: skip
        if changes and self._budget.seconds is None:
            with contextlib.suppress(ConfigError):  # then each search finds its own
                self._bench.draw(changes, PAIRS, 1, self._bench.turning_block)

    def _keep_traces(self, made: Challenge) -> None:
        """Simulate the variations with the smallest and the largest effect again, with their traces."""
        told = [one for one in made.found if one.judged and one.judged.effect is not None]
        if told and not self._bench.is_over:
            self._bench.keep_traces([find(told, key=_effect).variation for find in (min, max)])


def _tell(text: str) -> None:
    print(f"runner: {text}", file=sys.stderr)


def _finite(size: float) -> float:
    """Return the size of an effect; 0 if only one side has a value, whose answer no share of its size can end."""
    return size if math.isfinite(size) else 0.0


def _effect(one: AnsweredVariation) -> float:
    return one.judged.effect if one.judged and one.judged.effect is not None else 0.0


def _ends(made: Challenge) -> list[int]:
    """Return the nearest variation of each family and direction that reverses the answer, else that ends it."""
    nearest: dict[tuple[str, int, bool], int] = {}
    for place, one in enumerate(made.found):
        family = family_of(one.variation)
        if one.judged is None or one.judged.word not in _ENDS or family is None or family.neutral is None:
            continue
        if not isinstance(one.variation.value, int | float):
            continue
        distance = float(one.variation.value) - family.neutral
        key = (one.variation.family, one.variation.place, distance > 0.0)
        known = nearest.get(key)
        if known is None or _rank(made.found[known], family.neutral) > _rank(one, family.neutral):
            nearest[key] = place
    return sorted(nearest.values())


def _rank(one: AnsweredVariation, neutral: float) -> tuple[bool, float]:
    is_reversed = one.judged is not None and one.judged.word == "reversed"
    return not is_reversed, abs(float(one.variation.value) - neutral)


def _rounded(turn: Turn) -> float:
    """Return a turning value with the digits that its span supports."""
    if turn.low is None or turn.high is None or turn.high <= turn.low:
        return float(f"{turn.value:.2g}")
    digits = max(1, 1 - math.floor(math.log10((turn.high - turn.low) / max(abs(turn.value), turn.high - turn.low))))
    return float(f"{turn.value:.{digits}g}")


def _differences(a: Drawn, b: Drawn) -> FloatArray:
    failed = np.isinf(a.values) | np.isinf(b.values)
    return np.where(failed, np.inf, np.where(failed, 0.0, b.values) - np.where(failed, 0.0, a.values))


def _scale(found: PairedComparison) -> float | None:
    """Return the value that differences are relative to if the metric may be zero, null or signed; else None."""
    both = np.stack([found.a, found.b])
    return None if (np.isfinite(both) & (both > 0.0)).all() else max(larger_median(found), ROUNDING)
