"""Caveat of a run, and the result of all rules."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class Caveat:
    """One reason why a result may not be what it seems.

    Attributes:
        rule: Name of the rule, and of the group of its threshold.
        text: What it found, in words.
        value: What it measured, the worst over joints and repetitions; above the rule's threshold.
    """

    rule: str
    text: str
    value: float


@dataclass(frozen=True)
class Found:
    """All that the rules found in a run.

    Attributes:
        caveats: One for each rule that was sprung.
        digest: Digest of the rules' source.
        thresholds: What a run had to exceed, by rule and key.
    """

    caveats: Sequence[Caveat]
    digest: str
    thresholds: Mapping[str, Mapping[str, float]]

    def record(self) -> dict[str, Any]:
        """Return what is stored of it."""
        return {
            "caveats": [asdict(caveat) for caveat in self.caveats],
            "caveat_rules": {"digest": self.digest, "thresholds": self.thresholds},
        }
