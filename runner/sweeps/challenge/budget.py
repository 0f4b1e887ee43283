"""Budget of a challenge: a time, or a number of variations."""

import re
from dataclasses import dataclass

from runner.base.errors import RunnerError

_MINUTE = 60.0  # s


@dataclass(frozen=True)
class ChallengeBudget:
    """What a challenge may cost.

    Attributes:
        seconds: Wall-clock time after which no further runs start, in s; None for no limit.
        variations: Number of variations to try; None for all.
        text: The budget as given; empty for none.
    """

    seconds: float | None = None
    variations: int | None = None
    text: str = ""


def read_budget(text: str) -> ChallengeBudget:
    """Return the budget of a text such as "60s", "2min" or "12".

    Raises:
        RunnerError: for any other text.
    """
    found = re.fullmatch(r"(\d+(?:\.\d+)?)\s*(s|min)?", text)
    if found and float(found[1]) > 0.0:
        if found[2]:
            return ChallengeBudget(seconds=float(found[1]) * (_MINUTE if found[2] == "min" else 1.0), text=text)
        if found[1].isdecimal():
            return ChallengeBudget(variations=int(found[1]), text=f"{text} variation{'s' if int(text) > 1 else ''}")
    raise RunnerError(f"--budget: not a budget ('{text}'). Allowed: a time such as 60s, or a number of variations.")
