"""Published claims in a report, each with its verdicts, and their counts on the first screen."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from runner.papers.reporting.equation import EquationVerdict
from runner.papers.reporting.published_claims import Verdict
from runner.reporting.block import ReportBlock
from runner.reporting.table import Origin
from runner.reporting.verdicts import Tally, VerdictSquare


@dataclass(frozen=True)
class ClaimResult:
    """Result of the runs for one claim under one preset.

    Attributes:
        preset: Name of the preset; empty where there is one way to take the claim.
        measured: Median and spread over the seeds, formatted with unit, such as "1.41 s (1.12 to 1.77)".
        verdict: How it compares with what the source says.
        words: What the preset is called.
        hangs: What the verdict hangs on, such as the engine, and what it would be otherwise; empty for nothing.
    """

    preset: str
    measured: str
    verdict: Verdict | EquationVerdict
    words: str = ""
    hangs: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Claim:
    """A published number and the simulated one, with a verdict for each preset.

    Attributes:
        number: Its number in our list of claims.
        statement: What the source says.
        place: Where it says so, such as "section 3.3.1, page 38".
        printed: The printed value, formatted with unit; empty for a statement without a number.
        findings: One for each preset.
        reason: Why the verdict is what it is; inline mathematics as in Text.
        command: The command of its runs.
    """

    number: str
    statement: str
    place: str
    printed: str
    findings: Sequence[ClaimResult]
    reason: str
    command: str = ""

    @property
    def place_name(self) -> str:
        """Name of its place in the report."""
        return f"claim-{self.number}"


@dataclass(frozen=True)
class Verdicts(ReportBlock):
    """Claims of a source, each with its verdicts and their reason.

    Attributes:
        caption: What is listed; inline mathematics as in Text.
        rows: The claims, in the order of the source; each with as many findings.
        legend: What the words of the verdicts mean, in a few sentences; inline mathematics as in Text.
        origin: Command and commit.
    """

    block: ClassVar[str] = "verdicts"
    templates: ClassVar[str] = "papers"
    word: ClassVar[str] = "table"
    actions: ClassVar[tuple[str, ...]] = ("csv",)
    caption: str
    rows: Sequence[Claim]
    legend: str = ""
    origin: Origin = field(default_factory=Origin)

    @property
    def ways(self) -> list[str]:
        """Names of the ways in which each claim was simulated."""
        return [found.words or "simulated" for found in self.rows[0].findings] if self.rows else []

    @property
    def has_printed(self) -> bool:
        """True if the source prints a value for a claim."""
        return any(claim.printed for claim in self.rows)

    def texts(self) -> Iterator[str]:
        """Yield the caption and the reasons."""
        yield self.caption
        yield from (claim.reason for claim in self.rows)

    def places(self) -> Iterable[str]:
        """Return the names of the places of the claims."""
        return [claim.place_name for claim in self.rows]

    def tallies(self) -> Iterable[Tally]:
        """Yield the verdicts of each way of simulating the claims."""
        for number, way in enumerate(self.ways):
            squares = [_square(claim, claim.findings[number]) for claim in self.rows]
            yield Tally.of(way, squares, [square.verdict for square in squares])


def _square(claim: Claim, result: ClaimResult) -> VerdictSquare:
    hangs = f"; depends on {', '.join(result.hangs)}" if result.hangs else ""
    words = f"Claim {claim.number}: {result.verdict}{hangs}"
    return VerdictSquare(claim.number + "*" * bool(result.hangs), result.verdict, claim.place_name, words)


def find_conditional_claims(blocks: Iterable[ReportBlock]) -> str:
    """Return the claims whose verdict depends on more than they say, and the reasons; empty without one."""
    conditions: dict[str, list[str]] = {}
    for block in blocks:
        for row in block.rows if isinstance(block, Verdicts) else ():
            for what in dict.fromkeys(what for result in row.findings for what in result.hangs):
                conditions.setdefault(what, []).append(row.number)
    told = "; ".join(f"on {what}: claim {', '.join(claims)}" for what, claims in conditions.items())
    return f"* Verdicts that depend {told}." if told else ""
