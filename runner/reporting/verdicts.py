"""Verdicts in reports, and kinds of notices: sign, colour, plural and meaning of each."""

from typing import NamedTuple


class Word(NamedTuple):
    """A verdict, or a kind of notice.

    Attributes:
        sign: Sign before it, for readers who see no colours.
        color: Name of its colours in the styles: good, better, warn, bad or none.
        plural: The word after a number above 1; empty if it is the same.
        meaning: The meaning of a verdict on an equation.
    """

    sign: str
    color: str
    plural: str = ""
    meaning: str = ""


WORDS = {
    "matches": Word("=", "good", "match"),
    "differs": Word("≠", "bad", "differ"),
    "smaller than printed": Word("<", "better"),
    "larger than printed": Word(">", "bad"),
    "source contradicts itself": Word("!", "warn"),
    "undecided": Word("?", "none"),
    "correct": Word("✓", "good", meaning="equal to both derivations, except for rounding, everywhere tried"),
    "correct after emendation": Word("✓", "better", meaning="so once damage of the text is emended"),
    "wrong as printed": Word("✕", "bad", meaning="not so; the right form follows, with what differs marked"),
    "unreadable": Word("?", "warn", meaning="too much of the text is lost"),
    "definition": Word("–", "none", meaning="it only names things"),
    "refused": Word("✕", "bad"),
    "fixed": Word("!", "warn"),
    "note": Word("–", "none"),
    "finding": Word("", "better"),
    "stands": Word("", "good"),
    "falls": Word("", "bad"),
    "turns": Word("", "warn"),
    "why": Word("", "none"),
    "warning": Word("", "warn"),
    "failure": Word("", "bad"),
}
"""Every verdict on a claim, an equation or a robot file, and every kind of notice."""
