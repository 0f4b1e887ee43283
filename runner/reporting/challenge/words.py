"""Sentences of a challenge: for which families of choices its answer holds, where it ends, and what was left out."""

from collections import Counter
from collections.abc import Iterator, Sequence

from runner.base.quantities import number
from runner.base.sanitize import few
from runner.reporting.metric_titles import capital, title
from runner.reporting.table import Table, numbers
from runner.statistics.conclusion import SHARE
from runner.statistics.scope import TOLD, Word
from runner.statistics.turning import Turn
from runner.sweeps.challenge.question import CLASSES, Class
from runner.sweeps.challenge.stored import AnsweredVariation, Challenge, Turning

TITLES = {
    "engine": "other engines",
    "step": "a finer step",
    "goal": "other goals",
    "direction": "the reversed direction",
    "velocity": "another velocity estimate",
    "noise_kind": "another kind of noise",
    "duration": "other durations",
    "noise": "other noise levels",
    "torque_limit": "torque limits",
    "payload": "an unknown payload",
    "friction": "dry friction",
    "delay": "a delay",
    "period": "another control period",
    "model_error": "wrong masses in the model",
    "gain": "other gains of both",
    "gain_of_one": "another gain of only one",
}
"""Titles of the families in sentences."""

NOT_DONE = (
    "Gains are not tuned again at another limit, rate or duration. Another gain of both is another bandwidth. The "
    "integration error is that of the asked case. Sizes of different variations are not subtracted from each other."
)
"""What a challenge does not do, for each page on it."""

KEPT: Sequence[Word] = ("holds", "holds, weaker", "does not appear")
"""Words of a variation that does not change the answer."""

_FULL: Sequence[Word] = ("holds", "does not appear")  # and leaves at least half of its size

_BAD: Sequence[Word] = ("neither works", "only one works", "cannot be asked")
_NAMED = 8  # families that a sentence names


def answer_text(made: Challenge) -> str:
    """Return the answer of the asked case on fresh seeds, such as "29 % smaller with b than with a".

    If one side has no value, there is no difference to say: "only b has a value, a has none".
    """
    question, fresh = made.question, made.fresh
    a, b = (side.name for side in question.sides)
    if not question.sign:
        return f"no difference that counts is shown between {a} and {b}"
    effect = question.size if fresh is None or fresh.effect is None else fresh.effect
    smaller, larger = (b, a) if question.sign < 0 else (a, b)  # the effect is a share of the larger one
    if effect is None:
        return f"only {smaller} has a value, {larger} has none"
    return f"{_size(effect, question.is_fraction)} smaller with {smaller} than with {larger}".strip()


def scope_sentences(made: Challenge) -> list[str]:
    """Return the answer with its scope in sentences, the first one with the metric."""
    question = made.question
    head = f"{capital(title(question.metric))}: {answer_text(made)}"
    at = f" (at {question.at})" if question.at else ""
    if made.fresh is None:
        return [f"{head}{at}; the challenge was interrupted: the same command continues it."]
    if not made.came_back:
        pairs = made.fresh.pairs
        said = f"{capital(title(question.metric))}{at}: the stored answer does not come back on fresh seeds"
        return [f"{said} ({pairs} pairs). Nothing else was tried: simulate more repetitions first."]
    drawn = f"on fresh seeds too ({made.fresh.pairs} pairs)" if made.fresh.pairs > 1 else "exactly: nothing is drawn"
    texts = [f"{head}{at}, {drawn}."]
    for kind in CLASSES:
        texts += _of_class(made, kind)
    texts += _together(made)
    if question.left:
        texts.append(f"{_count(question.left, 'other condition')} of the result not asked; --where chooses one.")
    if made.left_out:
        counts = Counter(TITLES.get(one.family, one.family) for one in made.left_out)
        tried = Counter(TITLES.get(one.variation.family, one.variation.family) for one in made.found)
        parts = [f"{few} of {few + tried[name]} {name}" if tried[name] else name for name, few in counts.items()]
        texts.append(f"Left out: {', '.join(parts)}.")
    if cut := _cut(made):
        texts.append(f"Not tried within the budget of {made.budget}: {cut}.")
    return texts


def challenge_answer(made: Challenge) -> str:
    """Return the first sentence and the scope, for a list of results."""
    return f"{scope_sentences(made)[0]} {short_scope(made) if made.came_back else ''}".strip()


def short_scope(made: Challenge) -> str:
    """Return the scope in one sentence, to follow a conclusion."""
    if not made.came_back:
        return "Challenged: the answer does not come back on fresh seeds."
    kept = [kind for kind in CLASSES if _all_kept(made, kind)]
    turned = [one for one in made.found if one.judged and one.judged.word in TOLD and one.judged.word not in KEPT]
    held = f"it holds for all tried {' and '.join(CLASSES[kind] for kind in kept)}" if kept else ""
    names = list(dict.fromkeys(TITLES.get(one.variation.family, one.variation.family) for one in turned))
    ends = f"it ends or turns with {few(names, _NAMED)}" if turned else ""
    at = f" at {made.question.at}" if made.question.left else ""
    cut = f"not tried within the budget: {_cut(made)}" if made.cut else ""
    return f"Challenged{at}: {'; '.join(filter(None, (held, ends, cut))) or 'no variation is decided'}."


def variations_table(made: Challenge) -> Table:
    """Return a row for each variation: class, change, word, effect, interval and pairs."""
    rows = [
        [CLASSES[one.variation.kind], one.variation.label, word_text(made, one), *_numbers(made, one)]
        for one in made.found
    ]
    rows += [["left out", f"{one.family}={one.value}", one.reason, "", "", ""] for one in made.left_out]
    header = ["class", "changed", "answer", *numbers("effect", "interval", "pairs")]
    return Table("", header, rows)


def word_text(made: Challenge, one: AnsweredVariation) -> str:
    """Return the word of a variation with what belongs to it."""
    if one.judged is None:
        return "not tried: budget" if made.came_back else "not tried"
    if one.judged.works is not None:
        return f"only {made.question.sides[one.judged.works].name} works"
    if one.reason:
        return f"cannot be asked: {one.reason}"
    if one.judged.needed:
        return f"{one.judged.word} ({number(float(one.judged.needed), 2)} pairs would)"
    return one.judged.word


def combinations_table(made: Challenge) -> Table:
    """Return a row for each combination that was tried: its changes, effect and pairs."""
    rows = [
        ["; ".join(one.labels), _effect_text(made, one.effect) or "a side does not work", str(one.pairs)]
        for one in made.combined
        if one.pairs
    ]
    return Table("", ["changed together", *numbers("effect", "pairs")], rows)


def _together(made: Challenge) -> Iterator[str]:
    """Yield the description of the combinations that were tried."""
    tried = [one for one in made.combined if one.pairs]
    effects = sorted(one.effect for one in tried if one.effect is not None)
    if not tried:
        return
    texts = []
    if effects:
        sign = made.question.sign or 1
        same, other = (sum(each * sign * way > SHARE for each in effects) for way in (1, -1))
        words = ("the same sign", "the other sign") if made.question.sign else ("larger", "smaller")
        near = len(effects) - same - other
        texts = [f"{text} in {count}" for text, count in ((words[0], same), ("within 2 %", near), (words[1], other))]
        texts[-1] += f" ({_effect_text(made, effects[0])} to {_effect_text(made, effects[-1])})"
    texts += [f"a side does not work in {len(tried) - len(effects)}"] if len(tried) > len(effects) else []
    seed = made.question.seed
    yield f"{_count(len(tried), 'combination')} of two to four changes (seed {seed}), not tested: {', '.join(texts)}."


def _cut(made: Challenge) -> str:
    """Return the numbers of variations and combinations that the budget cut; empty for none."""
    together = sum(not one.pairs for one in made.combined) if made.ended else 0
    counts = ((len(made.cut), "variation"), (together, "combination"))
    return ", ".join(_count(count, noun) for count, noun in counts if count)


def _effect_text(made: Challenge, effect: float | None) -> str:
    """Return a relative effect in per cent, or that of a fraction; empty without one."""
    if effect is None:
        return ""
    return number(effect, 2) if made.question.is_fraction else f"{number(100.0 * effect, 2)} %"


def class_of(made: Challenge, kind: Class) -> list[AnsweredVariation]:
    """Return the variations of a class."""
    return [one for one in made.found if one.variation.kind == kind]


def is_kept(made: Challenge, one: AnsweredVariation) -> bool:
    """Return True if a variation does not change the answer: also if only the same side works as in the asked case."""
    return _word(one) in KEPT or _is_as_asked(made, one)


def _is_as_asked(made: Challenge, one: AnsweredVariation) -> bool:
    works = made.fresh.works if made.fresh else None
    return works is not None and one.judged is not None and one.judged.works == works


def _all_kept(made: Challenge, kind: Class) -> bool:
    found = class_of(made, kind)
    return bool(found) and all(is_kept(made, one) for one in found)


def _of_class(made: Challenge, kind: Class) -> Iterator[str]:
    """Yield the sentences of a class."""
    found = [one for one in class_of(made, kind) if one.judged]
    if not found:
        return
    if kind == "numbers":
        yield from _settled(made, found)
        return
    families: dict[str, list[AnsweredVariation]] = {}
    for one in found:
        families.setdefault(one.variation.family, []).append(one)
    whole = [name for name, some in families.items() if all(_word(one) in _FULL for one in some)]
    verb = "Does not appear with" if not made.question.sign else "Holds for"
    if whole:
        yield f"{verb} {', '.join(TITLES.get(name, name) for name in whole)}."
    rest = [one for one in found if one.variation.family not in whole]
    kept = [one for one in rest if _word(one) in _FULL]
    if kept:
        yield f"{verb.removesuffix(' for').removesuffix(' with')} with {_labels(made, kept)}."
    weaker = [f"{one.variation.label} ({_numbers(made, one)[0]})" for one in rest if _word(one) == "holds, weaker"]
    if weaker:
        yield f"Holds, but weaker, with {'; '.join(weaker)}."
    for word, text in (
        ("vanishes", "Ends with"),
        ("appears", "Appears with"),
        ("reversed", "Reversed with"),
        ("neither works", "Neither works with"),
        ("cannot be asked", "Cannot be asked with"),
    ):
        some = [one for one in rest if _word(one) == word]
        if some:
            yield f"{text} {_labels(made, some)}.{_turned(made, some)}"
    for side in (0, 1):
        some = [one for one in rest if one.judged and one.judged.works == side]
        if some:
            yield f"Only {made.question.sides[side].name} works with {_labels(made, some)}."
    untold = [one for one in rest if _word(one) == "not shown"]
    if untold:
        yield f"Not shown with {'; '.join(map(_untold, untold))}."


def _settled(made: Challenge, found: Sequence[AnsweredVariation]) -> Iterator[str]:
    kept = [one for one in found if _word(one) in _FULL or _is_as_asked(made, one)]
    if len(kept) == len(found):
        yield f"Settled numerically ({'; '.join(one.variation.label for one in found)})."
        return
    changed = [one for one in found if one not in kept]
    texts = [f"{one.variation.label} ({word_text(made, one)})" for one in changed]
    yield f"Not settled numerically: {'; '.join(texts)}."


def _turned(made: Challenge, some: Sequence[AnsweredVariation]) -> str:
    """Return the turning values of some variations."""
    texts = []
    for turning in made.turnings:
        if made.found[turning.variation] not in some:
            continue
        texts += [f"the sign changes near {label} ({_span(turn)})"
                  for label, turn in zip(turning.labels, turning.turns, strict=True)]  # fmt: skip
        texts += [f"it vanishes from {turning.label} on"] if turning.label else []
    return f" {capital('; '.join(texts))}." if texts else ""


def _span(turn: Turn) -> str:
    if turn.between is not None:
        return f"between the values {number(turn.between[0])} and {number(turn.between[1])}"
    ends = ["below" if turn.low is None else number(turn.low), "above" if turn.high is None else number(turn.high)]
    return f"95 % span of its value {ends[0]} to {ends[1]}"


def turning_rows(made: Challenge) -> Iterator[tuple[Turning, str, str]]:
    """Yield each search with the variation at its end and its result in words."""
    for turning in made.turnings:
        label = made.found[turning.variation].variation.label
        texts = [f"{text} ({_span(turn)})" for text, turn in zip(turning.labels, turning.turns, strict=True)]
        yield turning, label, "; ".join(texts) or (f"vanishes from {turning.label} on" if turning.label else "no turn")


def _untold(one: AnsweredVariation) -> str:
    needed = one.judged.needed if one.judged else None
    return f"{one.variation.label}{f' ({number(float(needed), 2)} pairs would tell)' if needed else ''}"


def _labels(made: Challenge, some: Sequence[AnsweredVariation]) -> str:
    """Return the changes of some variations; the title of a family if all its variations are among them."""
    sizes = {name: sum(one.variation.family == name for one in made.found) for name in TITLES}
    texts = []
    for one in some:
        name = one.variation.family
        whole = 1 < sizes.get(name, 0) == sum(other.variation.family == name for other in some)
        texts.append(f"{TITLES[name]} ({sizes[name]} of {sizes[name]})" if whole else one.variation.label)
    return "; ".join(dict.fromkeys(texts))


def _word(one: AnsweredVariation) -> str:
    return one.judged.word if one.judged else ""


def _size(effect: float, is_fraction: bool) -> str:
    return number(abs(effect), 2) if is_fraction else f"{number(100.0 * abs(effect), 2)} %"


def _numbers(made: Challenge, one: AnsweredVariation) -> list[str]:
    judged = one.judged
    if judged is None or judged.effect is None:
        return ["", "", str(judged.pairs) if judged and judged.pairs else ""]
    factor, unit = (1.0, "") if made.question.is_fraction else (100.0, " %")
    ends = "exact" if judged.low == judged.high and judged.pairs == 1 else "–"
    if judged.low is not None and judged.high is not None and ends != "exact":
        ends = f"{number(factor * judged.low, 2)} to {number(factor * judged.high, 2)}{unit}"
    return [f"{number(factor * judged.effect, 2)}{unit}", ends, str(judged.pairs)]


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'s' if count != 1 else ''}"
