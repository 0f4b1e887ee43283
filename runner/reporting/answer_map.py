"""Map of answers: rows and columns are conditions, and each cell names the better law."""

from collections.abc import Sequence
from dataclasses import dataclass

from runner.reporting.answers import Answer
from runner.reporting.comparison.pairs import label_text
from runner.reporting.conditions import ConditionAnswers, conditions_of
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title

MOST_CELLS = 24
"""Cells of a map. More conditions: those with the largest differences."""

_MOST_COLUMNS = 4
_SATURATED = " * A joint is at its torque limit at more ticks than the caveat saturation allows."


@dataclass(frozen=True)
class MapCell:
    """A cell of a map of answers.

    Attributes:
        text: The answer.
        color: Index of the winner among the compared names, which gives the colour; None without a winner.
    """

    text: str
    color: int | None = None


@dataclass(frozen=True)
class AnswerMap:
    """A map of answers.

    Attributes:
        caption: What it shows; inline mathematics as in Text.
        corner: What the rows are.
        columns: Titles of the columns.
        rows: Title of each row with its cells, one for each column.
    """

    caption: str
    corner: str
    columns: Sequence[str]
    rows: Sequence[tuple[str, Sequence[MapCell]]]


def make_map(answers: Sequence[Answer]) -> AnswerMap | None:
    """Return the map of the answers in the primary metric; None with fewer than two conditions."""
    metric = next((one.metric for one in answers if one.rank == 0), "")
    found = conditions_of(answers, metric)
    if len(found) < 2:
        return None
    names = list(dict.fromkeys(name for each in found for name in each.names))
    n, family = max(max((one.comparison.n, one.family) for one in each.answers) for each in found)
    caption = (
        f"Smaller {title(metric)} by condition, in per cent of the larger one. Not shown: {n} pairs show no difference "
        f"in {family} comparisons."
    )
    if len(found) > MOST_CELLS:
        largest = sorted(sorted(range(len(found)), key=lambda place: -found[place].size)[:MOST_CELLS])
        caption += f" {MOST_CELLS} of {len(found)} conditions are shown, those with the largest differences."
        rows = [(label_text(found[place].at), [_cell(found[place], names)]) for place in largest]
        return AnswerMap(literal(caption + _marked(rows)), "condition", ["answer"], rows)
    across = _column_key(found)
    columns = list(dict.fromkeys(each.at[across] for each in found)) if across else ["answer"]
    lines: dict[str, dict[str, MapCell]] = {}
    for each in found:
        rest = {key: value for key, value in each.at.items() if key != across}
        name = ", ".join(rest.values() if len(rest) == 1 else (f"{key}={value}" for key, value in rest.items()))
        lines.setdefault(name, {})[each.at.get(across, "answer")] = _cell(each, names)
    rows = [(name, [cells.get(column, MapCell("–")) for column in columns]) for name, cells in lines.items()]
    down = ", ".join(key for key in found[0].at if key != across)
    heads = [f"{across}={column}" for column in columns] if across else columns
    return AnswerMap(literal(caption + _marked(rows)), down, heads, rows)


def _column_key(found: Sequence[ConditionAnswers]) -> str:
    """Return the condition with the fewest values, the last of several, as columns; "" for a single condition."""
    counts = {key: len({each.at[key] for each in found}) for key in found[0].at}
    fits = [key for key, count in counts.items() if count <= _MOST_COLUMNS]
    return min(reversed(fits), key=lambda key: counts[key]) if len(counts) > 1 and fits else ""


def _cell(condition: ConditionAnswers, names: Sequence[str]) -> MapCell:
    color = names.index(condition.winner) if condition.winner else None
    return MapCell(f"{condition.word}{' *' if condition.is_saturated else ''}", color)


def _marked(rows: Sequence[tuple[str, Sequence[MapCell]]]) -> str:
    return _SATURATED if any(cell.text.endswith("*") for _, cells in rows for cell in cells) else ""
