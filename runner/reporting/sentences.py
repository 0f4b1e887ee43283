"""Answers of a first screen in sentences, and their short table."""

import math
from collections import Counter
from collections.abc import Sequence

from runner.reporting.answers import Answer
from runner.reporting.comparison.pairs import label_text
from runner.reporting.conditions import ConditionAnswers, conditions_of
from runner.reporting.metric_titles import capital, title
from runner.reporting.table import Column, numbers
from runner.statistics import fewest_pairs
from runner.statistics.conclusion import ALPHA

_MOST_SENTENCES, _MOST_CONDITIONS = 6, 6
_LONG = {"not shown": "no difference shown"}  # words of the map of answers, in a sentence


def sentences(answers: Sequence[Answer]) -> list[str]:
    """Return the answers in the primary metric as sentences: pooled if that describes all conditions, else for each.

    A sentence on a smaller value also says what it costs.
    """
    first = [one for one in answers if one.rank == 0]
    overall = [one for one in first if not one.at]
    if not first:
        return []
    if not any(one.is_answerable for one in first):
        n, family = max((one.comparison.n, one.family) for one in first)
        pairs = "1 pair is" if n == 1 else f"{n} pairs are"
        return [f"{pairs} too few for {_count(family, 'comparison')}: {fewest_pairs(ALPHA / family)} would do."]
    found = conditions_of(first, first[0].metric)
    if overall:
        texts = [one.sentence(price(one, answers)) for one in overall]
        texts = [*_some(texts, _MOST_SENTENCES), *([_agreement(found)] if len(found) > 1 else [])]
    else:
        texts = [_headline(found), *_some([text for each in found for text in _at(each, answers)], _MOST_CONDITIONS)]
    left_out = [one for one in first if not one.is_answerable]
    return [*texts, *([unanswerable(left_out)] if left_out else [])]


def price(one: Answer, answers: Sequence[Answer]) -> str:
    """Return the cost of the smaller value in the second metric of the first screen, to end a sentence; or ""."""
    same = (each for each in answers if each.rank == 1 and (each.at, each.names) == (one.at, one.names))
    cost = next(same, None)
    if cost is None or not one.sign:
        return ""
    name = title(cost.metric)
    if cost.limit:
        return f"; its {name} is not compared: {cost.limit}"
    if not cost.sign:
        return f"; no difference in {name} is shown"
    compared = "smaller" if cost.sign == one.sign else "larger"
    if not math.isfinite(cost.comparison.difference):
        return f"; its {name} is {compared}, as one of both is beyond every number"
    return f"; its {name} is {compared} by {cost.printed.amount}, of {cost.printed.values[cost.sign > 0]}"


def unanswerable(left_out: Sequence[Answer]) -> str:
    """Return the number of repetitions that answer the comparisons left out because of too few pairs."""
    needed = max(one.fewest for one in left_out)
    are = "comparison has" if len(left_out) == 1 else "comparisons have"
    return f"{len(left_out)} {are} too few pairs ({max(one.comparison.n for one in left_out)}): {needed} would do."


def _some(texts: list[str], most: int) -> list[str]:
    left = len(texts) - most
    return texts[:most] + ([f"{left} more are in the tables."] if left > 0 else [])


def _at(condition: ConditionAnswers, answers: Sequence[Answer]) -> list[str]:
    return [f"At {label_text(condition.at)}: {one.clause(price(one, answers))}"
            for one in condition.answers if one.is_answerable and not one.is_lost]  # fmt: skip


def _agreement(found: Sequence[ConditionAnswers]) -> str:
    """Return in how many conditions a pooled answer also holds in a single condition."""
    return f"By condition: {_tally(found)}."


def _headline(found: Sequence[ConditionAnswers]) -> str:
    """Return the metric, and in how many conditions which name is smaller."""
    metric = capital(title(found[0].answers[0].metric))
    winners = {each.winner for each in found} - {""}
    depends = "the answer depends on the conditions: " if len(winners) > 1 else ""
    return f"{metric}: {depends}{_tally(found)}."


def _tally(found: Sequence[ConditionAnswers]) -> str:
    """Return the number of conditions by answer, such as "a is smaller in 2 of 4 (12 to 31 %), not shown in 2"."""
    texts = []
    for name, count in Counter(each.winner for each in found if each.winner).most_common():
        shares = [float(each.share.split()[0]) for each in found if each.winner == name and _is_plain(each.share)]
        low, high = (f"{end:g}" for end in (min(shares, default=0.0), max(shares, default=0.0)))
        spread = f" ({low if low == high else f'{low} to {high}'} %)" if len(shares) == count else ""
        texts.append(f"{name} is smaller in {count} of {len(found)} conditions{spread}")
    others = Counter(each.word.partition(" (")[0] for each in found if not each.winner)
    rest = [f"{_LONG.get(word, word)} in {count}" for word, count in others.items()]
    if rest and not texts:
        return f"{', '.join(rest)} of {_count(len(found), 'condition')}"
    return "; ".join([*texts, ", ".join(rest)] if rest else texts)


def _is_plain(share: str) -> bool:
    return bool(share) and "·" not in share


def _count(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def short_table(answers: Sequence[Answer], by_condition: bool = True) -> tuple[list[str | Column], list[list[str]]]:
    """Return header and rows of a short table: each metric pooled, or how many conditions have which answer.

    What too few pairs cannot answer is left out.

    Args:
        answers: The answers.
        by_condition: True for a row for each condition in the primary metric.
    """
    names = list(dict.fromkeys(one.names for one in answers))
    several = len(names) > 1
    rows: list[tuple[str, str, str, list[str]]] = []
    for metric in dict.fromkeys(one.metric for one in answers):
        found = [one for one in answers if one.metric == metric]
        conditions = conditions_of(found, metric)
        kept = [one for one in found if one.is_answerable and not one.at]
        if not kept and len(conditions) > 1:
            rows.append((metric, f"{len(conditions)} conditions", "", ["", "", _tally(conditions)]))
        if not several and ((by_condition and found[0].rank == 0) or len(conditions) == 1):
            kept += [one for one in found if one.is_answerable and one.at]
        rows += [(metric, one.place, ", ".join(one.names), one.short_cells) for one in kept]
    at = any(place != "all" for _, place, *_ in rows)
    first, second = ("first", "second") if several else (names[0] if names else ("A", "B"))
    header = ["metric", *["at"] * at, *["compared"] * several, *numbers(first, f"{second} - {first}"), "answer"]
    return header, [[title(metric), *[place] * at, *[both] * several, *cells] for metric, place, both, cells in rows]
