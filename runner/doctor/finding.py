"""One thing that the doctor has to say."""

from dataclasses import dataclass
from typing import Literal

Grade = Literal["refused", "finding", "note"]


@dataclass(frozen=True)
class Finding:
    """One observation with its mend.

    Attributes:
        grade: "refused": the runner cannot take the arm so; "finding": it should be mended; "note": good to know.
        place: The link or joint, or what was looked at.
        text: What was found.
        mend: What to do about it; "" where nothing needs doing.
        mended: Whether the copy that `--write` makes is free of it.
    """

    grade: Grade
    place: str
    text: str
    mend: str = ""
    mended: bool = False

    def __str__(self) -> str:
        mend = f"; {self.mend}" if self.mend else ""
        return f"{self.grade:<8} {self.place}: {self.text}{mend}{' [--write does it]' if self.mended else ''}"


def exit_code(findings: "list[Finding]") -> int:
    """Return 2 where something bars the arm, 1 where something is to be mended, 0 where it fits."""
    grades = {finding.grade for finding in findings}
    return 2 if "refused" in grades else 1 if "finding" in grades else 0
