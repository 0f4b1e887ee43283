"""How many claims of a report hold: the verdicts counted, and where each stands."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from runner.claims import CONTRADICTION
from runner.reporting.document import Document, Equations, Verdicts
from runner.reporting.equation import FOLDED, SHOWN
from runner.reporting.outline import blocks
from runner.reporting.places import claim_place, verdict_place

_OF_SEVERAL = {
    "holds": "hold",
    "no longer holds": "no longer hold",
    CONTRADICTION: "contradict themselves",
}


class Square(NamedTuple):
    """A square of the first screen.

    Attributes:
        number: What stands in it.
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
        """The counts in words, such as "12 of 16 hold, 3 better, 1 contradicts itself"."""
        total = sum(count for _, count in self.counts)
        told = [
            f"{count} {_OF_SEVERAL.get(verdict, verdict) if count > 1 else verdict}" for verdict, count in self.counts
        ]
        return ", ".join([told[0].replace(" ", f" of {total} ", 1), *told[1:]]) if told else ""


def tallies(document: Document) -> list[Tally]:
    """Return the verdicts of a report: on its claims, for each way of simulating them, and on its equations."""
    return list(_tallies(document))


def _tallies(document: Document) -> Iterator[Tally]:
    for block in blocks(document):
        if isinstance(block, Verdicts):
            for number, way in enumerate(block.ways):
                found = [(row.number, row.findings[number].verdict) for row in block.rows]
                squares = tuple(
                    Square(claim, verdict, claim_place(claim), f"Claim {claim}: {verdict}") for claim, verdict in found
                )
                yield Tally(way, squares, _counted(verdict for _, verdict in found))
        if isinstance(block, Equations):
            counts = _counted(row.verdict for row in block.rows)
            squares = tuple(
                Square(str(count), verdict, verdict_place(block.source, verdict), f"{count} {verdict}")
                for verdict in (*SHOWN, *FOLDED)
                if (count := dict(counts).get(verdict, 0))
            )
            yield Tally(block.source or "equations", squares, counts)


def _counted(verdicts: Iterator[str]) -> tuple[tuple[str, int], ...]:
    return tuple(Counter(verdicts).most_common())
