"""Claims in a report: published number, simulated values and verdicts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from runner.reporting.claims import Verdict

EquationVerdict = Literal["correct", "correct after repair", "wrong as printed", "unreadable", "definition"]


@dataclass(frozen=True)
class ClaimResult:
    """What the runs give for one claim under one preset.

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
    """A published number beside ours, with a verdict for each preset.

    Attributes:
        number: Its number in our list of claims.
        statement: What the source says.
        place: Where it says so, such as "section 3.3.1, page 38".
        printed: The printed value, formatted with unit; empty where it is a statement in words.
        findings: One for each preset.
        reason: Why the verdict is what it is; inline mathematics as in Text.
        command: The command that makes the runs behind it.
    """

    number: str
    statement: str
    place: str
    printed: str
    findings: Sequence[ClaimResult]
    reason: str
    command: str = ""
