"""Format of values in sentences."""

import re
from typing import Any

from runner.base.quantities import number
from runner.study.measured import Measured
from runner.study.prose.expressions import PLACEHOLDER, PRIVATE, Values
from runner.study.prose.problem import ProseError


def filled(text: str, values: Values, file: str, mathematics: bool = False) -> str:
    """Return a text with its placeholders replaced by their values, none of which can become markup.

    Args:
        text: The text.
        values: The values of the chapter.
        file: Name of the chapter's file.
        mathematics: Whether the text stands between dollar signs, where only numbers may be inserted.

    Raises:
        ProseError: if a value is nothing that a sentence shows.
    """

    def show(found: re.Match[str]) -> str:
        value, line = values.found[int(found[1])]
        shown = _shown(value)
        if shown is None or (mathematics and not isinstance(value, int | float)):
            what = "a formula takes numbers" if mathematics else "a sentence takes texts, numbers and measured values"
            hint = "; a block stands in a paragraph of its own" if not mathematics else ""
            raise ProseError(file, line, f"{what}, not {type(value).__name__}{hint}")
        return PRIVATE.sub("\ufffd", shown).replace("$", "$$")

    return PLACEHOLDER.sub(show, text)


def _shown(value: Any) -> str | None:
    if isinstance(value, bool):
        return None
    if isinstance(value, str | Measured):
        return str(value)
    return number(value) if isinstance(value, int | float) else None
