"""Verdicts and kinds of notices in reports: their words, signs and colours, and the counts of the first screen."""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from runner.papers.reporting.equation import FOLDED, SHOWN
from runner.papers.reporting.published_claims import CONTRADICTION
from runner.reporting.document import Block, ClaimResult, Document, Equations, Verdicts
from runner.reporting.outline import blocks, claim_place, verdict_place


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


class Square(NamedTuple):
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
    squares: tuple[Square, ...]
    counts: tuple[tuple[str, int], ...]

    @property
    def words(self) -> str:
        """The counts as a phrase, such as "12 of 16 match, 3 smaller than printed, 1: source contradicts itself"."""
        told: list[str] = []
        total = sum(count for _, count in self.counts)
        for verdict, count in self.counts:
            number = f"{count}{'' if told else f' of {total}'}{':' * (verdict == CONTRADICTION)}"
            told.append(f"{number} {(count > 1 and WORDS[verdict].plural) or verdict}")
        return ", ".join(told)


def tallies(document: Document) -> list[Tally]:
    """Return the verdicts of a report: on its claims, for each way of simulating them, and on its equations."""
    found = []
    for block in blocks(document):
        if isinstance(block, Verdicts):
            for number, way in enumerate(block.ways):
                squares = tuple(_square(row.number, row.findings[number]) for row in block.rows)
                found.append(Tally(way, squares, _counted(square.verdict for square in squares)))
        if isinstance(block, Equations):
            counts = _counted(row.verdict for row in block.rows)
            squares = tuple(
                Square(str(count), verdict, verdict_place(block.source, verdict), f"{count} {verdict}")
                for verdict in (*SHOWN, *FOLDED)
                if (count := dict(counts).get(verdict, 0))
            )
            found.append(Tally(block.source or "equations", squares, counts))
    return found


def _square(claim: str, found: ClaimResult) -> Square:
    hangs = f"; depends on {', '.join(found.hangs)}" if found.hangs else ""
    words = f"Claim {claim}: {found.verdict}{hangs}"
    return Square(claim + "*" * bool(found.hangs), found.verdict, claim_place(claim), words)


def find_conditional_claims(document_blocks: Iterable[Block]) -> str:
    """Return the claims whose verdict depends on more than they say, and the reasons; empty without one."""
    found: dict[str, list[str]] = {}
    for block in document_blocks:
        for row in block.rows if isinstance(block, Verdicts) else ():
            for what in dict.fromkeys(what for result in row.findings for what in result.hangs):
                found.setdefault(what, []).append(row.number)
    told = "; ".join(f"on {what}: claim {', '.join(claims)}" for what, claims in found.items())
    return f"* Verdicts that depend {told}." if told else ""


def _counted(verdicts: Iterator[str]) -> tuple[tuple[str, int], ...]:
    return tuple(Counter(verdicts).most_common())
