"""Finding of an examination: grade, location, message and remedy."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
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


def ask_once(findings: Iterable[DoctorFinding], names: Sequence[str], most: int) -> list[DoctorFinding]:
    """Return findings, a question on several columns or joints as one, in the words for the first of them.

    Args:
        findings: Findings on a log.
        names: Columns and joints. Questions that differ only in these and in numbers are one.
        most: How many of the further columns a question names.
    """
    either = "|".join(re.escape(name) for name in sorted(names, key=len, reverse=True))
    pattern = re.compile(rf"(?<!\w)(?:{either})(?!\w)|[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
    same: dict[object, list[DoctorFinding]] = {}
    for place, each in enumerate(findings):
        words = (pattern.sub("", each.text), each.remedy)
        same.setdefault(words if each.grade == "ask" else place, []).append(each)
    order = {name: place for place, name in enumerate(names)}
    found = []
    for first, *others in same.values():
        rest = sorted((each.place.removeprefix("columns.") for each in others), key=lambda name: order.get(name, 0))
        found.append(replace(first, place=f"{first.place} (also {few(rest, most)})") if rest else first)
    return found
