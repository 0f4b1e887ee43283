"""Verdicts and kinds of notices in reports: their words, signs and colours, and counts of them."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple


class Word(NamedTuple):
    """A verdict, or a kind of notice.

    Attributes:
        sign: Sign before it, for readers who see no colours.
        color: Name of its colours in the styles: good, better, warn, bad or none.
        plural: The word after a number above 1; empty if it is the same.
        meaning: The meaning of a verdict on an equation.
        is_sentence: True if a colon parts it from a number.
    """

    sign: str
    color: str
    plural: str = ""
    meaning: str = ""
    is_sentence: bool = False


WORDS = {
    "matches": Word("=", "good", "match"),
    "differs": Word("≠", "bad", "differ"),
    "smaller than printed": Word("<", "better"),
    "larger than printed": Word(">", "bad"),
    "source contradicts itself": Word("!", "warn", is_sentence=True),
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


class VerdictSquare(NamedTuple):
    """A square of the first screen.

    Attributes:
        number: The number in it.
        verdict: The verdict that colours it.
        place: Where it leads to.
        words: What it says, for those who hear it.
    """

    number: str
    verdict: str
    place: str
    words: str


@dataclass(frozen=True)
class Tally:
    """The verdicts of one way in which the claims of a report were judged.

    Attributes:
        way: What the way is called.
        squares: A square for each claim, or for the equations of each verdict.
        counts: Number of each verdict, the most frequent first.
    """

    way: str
    squares: tuple[VerdictSquare, ...]
    counts: tuple[tuple[str, int], ...]

    @property
    def words(self) -> str:
        """The counts as a phrase, such as "12 of 16 match, 3 smaller than printed, 1: source contradicts itself"."""
        told: list[str] = []
        total = sum(count for _, count in self.counts)
        for verdict, count in self.counts:
            number = f"{count}{'' if told else f' of {total}'}{':' * WORDS[verdict].is_sentence}"
            told.append(f"{number} {(count > 1 and WORDS[verdict].plural) or verdict}")
        return ", ".join(told)

    @classmethod
    def of(cls, way: str, squares: Iterable[VerdictSquare], verdicts: Iterable[str]) -> "Tally":
        """Return the tally of some verdicts, the most frequent first."""
        return cls(way, tuple(squares), tuple(Counter(verdicts).most_common()))
