"""Finding of an examination: grade, location, message and remedy."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from runner.base.sanitize import few

Grade = Literal["refused", "ask", "fixed", "note"]
GRADES: tuple[Grade, ...] = ("refused", "ask", "fixed", "note")


@dataclass(frozen=True)
class DoctorFinding:
    """One observation with what was or can be done about it.

    Attributes:
        grade: "refused": the runner cannot take the arm so; "fixed": it was changed in the copy that --output
            makes; "note": good to know.
        place: The link or joint, or what was looked at.
        text: What was found; of what is fixed, as it was.
        remedy: What to do about it, or what was done; "" where nothing needs doing.
    """

    grade: Grade
    place: str
    text: str
    remedy: str = ""

    def __str__(self) -> str:
        return f"{self.grade:<7} {self.place}: {self.text}{'; ' if self.remedy else ''}{self.remedy}"


def together(findings: Iterable[DoctorFinding]) -> list[DoctorFinding]:
    """Return findings by grade, those of several links or joints in the same words as one."""
    places: dict[tuple[Grade, str, str, str], list[str]] = {}
    for each in findings:
        part = re.fullmatch(r"(link|joint) ('.*')", each.place)
        kind, name = part.groups() if part else (each.place, "")
        places.setdefault((each.grade, kind, each.text, each.remedy), []).append(name)
    found = [
        DoctorFinding(grade, f"{kind}{'s' if len(names) > 1 and names[0] else ''} {few(names)}".rstrip(), text, remedy)
        for (grade, kind, text, remedy), names in places.items()
    ]
    return sorted(found, key=lambda each: GRADES.index(each.grade))
