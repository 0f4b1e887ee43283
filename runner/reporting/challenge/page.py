"""Report on a challenge: its sentences, the specification curve, the table of variations and the turning values."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from runner.base.sanitize import one_line
from runner.reporting.challenge.words import (
    NOT_DONE,
    TITLES,
    class_of,
    combinations_table,
    is_kept,
    scope_sentences,
    turning_rows,
    variations_table,
    word_text,
)
from runner.reporting.document import (
    Code,
    Curves,
    Document,
    Panel,
    Provenance,
    ReportBlock,
    Section,
    Series,
    Table,
    Text,
)
from runner.reporting.markup import literal
from runner.reporting.metric_titles import capital, title
from runner.reporting.sections import added_sections, make_sections
from runner.reporting.sweep.report import run_command
from runner.store.sweep import Sweep
from runner.sweeps.challenge.question import CLASSES
from runner.sweeps.challenge.stored import AnsweredVariation, Challenge

_COLORS = {
    "holds": 0, "holds, weaker": 5, "does not appear": 0, "vanishes": 3, "appears": 1, "reversed": 1, "not shown": 4,
}  # fmt: skip
_GREY = 7
_GAP = 1.0  # between classes, in variations


@dataclass(frozen=True)
class ChallengeSubject:
    """A challenge as its report looks at it: the subject of the sections of the report.

    Attributes:
        challenge: The challenge.
        sweep: Its runs.
    """

    challenge: Challenge
    sweep: Sweep


def challenge_document(made: Challenge, sweep: Sweep) -> Document:
    """Return the report on a challenge.

    Args:
        made: The challenge.
        sweep: Its runs.
    """
    subject = ChallengeSubject(made, sweep)
    a, b = (side.name for side in made.question.sides)
    first, *others = scope_sentences(made)
    at = f", {made.question.at}" if made.question.at else ""
    own = make_sections(SECTIONS, subject)
    return Document(
        title=f"For which choices does the answer hold: {a} or {b}?",
        subtitle=literal(f"{capital(title(made.question.metric))}{at}"),
        abstract=literal("\n".join(map(one_line, [first, *others]))),
        sections=[*own[:-1], *added_sections("challenge", subject), own[-1]],
        date="",
    )


def _variations(subject: ChallengeSubject) -> Section | None:
    """Return the specification curve and the table of the variations."""
    made, sweep = subject.challenge, subject.sweep
    if not made.came_back:
        return None
    commands = dict(zip(sweep.hashes, map(run_command, sweep.overrides), strict=True))
    placed = list(_placed(made))
    blocks: list[ReportBlock] = []
    known = [(x, one) for x, one in placed if np.isfinite(_middle(made, one)[0])]
    if known:
        caption = (
            f"Specification curve: differences in {title(made.question.metric)} sorted within each class "
            f"({', '.join(CLASSES.values())}), with their intervals; below, the family that is changed. Without a dot "
            "above: one or both sides do not work. The line is the asked case."
        )
        panels = [_differences(made, known, commands, _ends(placed)), _choices(made, placed, commands)]
        blocks.append(Curves(literal(caption), panels, columns=1))
    return Section("Variations", [*blocks, variations_table(made)])


def _turns(subject: ChallengeSubject) -> Section | None:
    turned = [[label, text] for _, label, text in turning_rows(subject.challenge)]
    text = (
        "Five values between the asked one and the variation are simulated with 24 further pairs, then the roots "
        "of the difference and of both ends of its 95 % interval."
    )
    return Section("Where it turns", [Text(text), Table("", ["towards", "found"], turned)]) if turned else None


def _combinations(subject: ChallengeSubject) -> Section | None:
    made = subject.challenge
    if not any(one.pairs for one in made.combined):
        return None
    text = f"Changes are drawn from seed {made.question.seed}, each nearly equally often. Nothing is tested."
    return Section("Several changes at once", [Text(text), combinations_table(made)])


def _not_covered(_: ChallengeSubject) -> Section:
    return Section("Not covered", [Text(NOT_DONE)])


def _made(subject: ChallengeSubject) -> Section:
    made = subject.challenge
    return Section("Provenance", [Code(made.command), Provenance([("challenge", made.folder.name)])])


SECTIONS = (_variations, _turns, _combinations, _not_covered, _made)
"""Sections: functions of the subject that return a section or None; plug-ins add theirs before the last."""


def _placed(made: Challenge) -> Iterator[tuple[float, AnsweredVariation]]:
    """Yield the abscissa of each variation that was tried: sorted within its class, with a gap between classes."""
    start = 0.0
    for kind in CLASSES:
        some = [one for one in class_of(made, kind) if one.judged]
        found = sorted(some, key=lambda one: float(np.nan_to_num(_middle(made, one)[0], nan=np.inf)))
        for place, one in enumerate(found):
            yield start + place, one
        start += len(found) + _GAP if found else 0.0


def _middle(made: Challenge, one: AnsweredVariation) -> tuple[float, float, float]:
    """Return the ordinate of a variation and the ends of its interval: in per cent, as logarithms if all have them."""
    judged, nothing = one.judged, (np.nan, np.nan, np.nan)
    if judged is None or judged.effect is None:
        return nothing
    if _in_logarithms(made):
        return judged.log_ratio or nothing
    factor = 1.0 if made.question.is_fraction else 100.0
    low, high = (np.nan if end is None else factor * end for end in (judged.low, judged.high))
    return factor * judged.effect, low, high


def _in_logarithms(made: Challenge) -> bool:
    told = [one.judged for one in made.found if one.judged and one.judged.effect is not None]
    return all(one.log_ratio is not None for one in told)


def _differences(
    made: Challenge,
    known: Sequence[tuple[float, AnsweredVariation]],
    commands: Mapping[str, str],
    x_range: tuple[float, float],
) -> Panel:
    a, b = (side.name for side in made.question.sides)
    series = []
    for word in dict.fromkeys(one.judged.word for _, one in known if one.judged):
        some = [(x, one) for x, one in known if one.judged and one.judged.word == word]
        middles = np.array([_middle(made, one) for _, one in some])
        x, y, color = np.array([each for each, _ in some]), middles[:, 0], _COLORS.get(word, _GREY)
        ends = np.column_stack([middles[:, 1:], np.full(len(x), np.nan)]).ravel()
        series.append(Series("", np.repeat(x, 3), ends, color=color))
        hints = [_hint(made, one, commands) for _, one in some]
        runs = [one.hashes[1] if len(one.hashes) > 1 else "" for _, one in some]
        series.append(Series(word, x, y, "points", color=color, hints=hints, runs=runs if all(runs) else ()))
    asked = made.fresh.log_ratio[0] if made.fresh and made.fresh.log_ratio and _in_logarithms(made) else None
    if asked is None and made.fresh and made.fresh.effect is not None:
        asked = (1.0 if made.question.is_fraction else 100.0) * made.fresh.effect
    ends = np.array(x_range)
    lines = [Series("", ends, np.zeros(2), "dotted", color=_GREY)]
    if asked is not None:
        lines.append(Series("asked case", ends, np.full(2, asked), "dashed", color=2))
    unit = f"logarithm of {b} / {a}" if _in_logarithms(made) else f"{b} - {a}"
    label = unit if _in_logarithms(made) or made.question.is_fraction else f"{unit} (%)"
    return Panel("", "variations", label, [*lines, *series], x_range=x_range)


def _choices(made: Challenge, placed: Sequence[tuple[float, AnsweredVariation]], commands: Mapping[str, str]) -> Panel:
    """Return a row of dots for each family, in the order of the classes from above."""
    families = list(dict.fromkeys(one.variation.family for _, one in placed))[::-1]
    series = []
    for row, name in enumerate(families):
        x = np.array([each for each, one in placed if one.variation.family == name])
        hints = [_hint(made, one, commands) for _, one in placed if one.variation.family == name]
        series.append(Series("", x, np.full(len(x), float(row)), "points", color=_GREY, hints=hints))
    names = [TITLES.get(name, name) for name in families]
    return Panel("", "variations", "", series, x_range=_ends(placed), y_names=names)


def _ends(placed: Sequence[tuple[float, AnsweredVariation]]) -> tuple[float, float]:
    return placed[0][0] - 0.5, placed[-1][0] + 0.5


def _hint(made: Challenge, one: AnsweredVariation, commands: Mapping[str, str]) -> str:
    command = commands.get(one.hashes[-1], "") if one.hashes else ""
    return f"{one.variation.label}: {word_text(made, one)}; {command}"


def turns_answer(made: Challenge, kinds: Sequence[str]) -> list[str]:
    """Return the reasons why the answer is not shown to hold for all variations of some classes; empty if it is."""
    if not made.came_back:
        return ["the stored answer does not come back on fresh seeds"]
    found = chain.from_iterable(class_of(made, kind) for kind in CLASSES if kind in kinds)
    turned = [one for one in found if not is_kept(made, one)]
    left = [one for one in made.left_out if one.kind in kinds]
    return [
        *(f"{one.variation.label}: {word_text(made, one)}" for one in turned),
        *(f"{one.family}={one.value}: left out, {one.reason}" for one in left),
    ]
