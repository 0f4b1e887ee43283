"""Equation names such as 0T_1 or J_g6,20, split into letters, subscripts and superscripts."""

import re
from dataclasses import dataclass

_NAME = re.compile(
    r"(?<!\w)(?P<frame>\d?)(?P<letter>[^\W\d_])"
    r"(?:_(?P<below>[^\W_]+(?:,\d\d)?)|(?P<digits>\d+)|(?P<difference>\(\d(?:-\d)+\)))?"
    r"(?:\^(?P<above>[\w+]+))?(?![\w\^])"
)


@dataclass(frozen=True)
class Symbol:
    """A letter with its scripts; or plain text, which has none and no letter.

    Attributes:
        text: The letter, or the text.
        frame: What stands above the line before it.
        below: What stands below the line behind it.
        above: What stands above the line behind it.
    """

    text: str
    frame: str = ""
    below: str = ""
    above: str = ""

    @property
    def plain(self) -> bool:
        """Whether it is text."""
        return not (self.frame or self.below or self.above)


def symbols_in(text: str) -> list[Symbol]:
    """Return a name in pieces: letters that have scripts, and the text between them."""
    found: list[Symbol] = []
    end = 0
    for match in _NAME.finditer(text):
        below = match["below"] or match["digits"] or (match["difference"] or "").replace("-", "−")
        if match["frame"] or below or match["above"]:
            found += [
                Symbol(text[end : match.start()]),
                Symbol(match["letter"], match["frame"], below, match["above"] or ""),
            ]
            end = match.end()
    return [each for each in (*found, Symbol(text[end:])) if each.text]
