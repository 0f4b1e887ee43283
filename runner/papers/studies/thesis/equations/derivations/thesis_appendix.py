"""Equations of motion of the six-joint arm, read from the text of the thesis' appendix.

The appendix writes each torque as a sum of groups, "(sum of terms) * product of velocities" or "... * acceleration",
and of gravity terms. A term is a fraction times the sine or cosine of a sum of joint positions. In the elements, `h_12`
is the group of dq1 dq2, `a_1` that of ddq1, and `g` is gravity.

Four kinds of damage are emended to read a row: a lost bracket of a group (it begins after the group before it, or ends
before its factor), a factor without the letter v or a ("q3^2" is a velocity, a lone "q1" an acceleration), a number
raised ("qv^2" for qv2), and a lost or stray product sign in an argument. Other characters are left out.
"""

import re
from functools import cache, partial
from pathlib import Path

_TERM = re.compile(r"([+-]?)(\d+(?:/\d+)?(?:\*(?=[sc]))?)?((?:sin|cos)\([-+*\dq]*\))?")
_OPENING = re.compile(r"[+-]?\(")
_FACTOR = re.compile(r"(?P<bracket>\)?)\*(?P<first>q[va]?\^?\d)(?P<square>\^2)?(?:\*(?P<second>q[va]?\^?\d))?(?![\d^])")

_Groups = dict[tuple[str, str], list[str]]
"""Terms of each group by its name and its motion, such as h_12 and "*dq1*dq2"."""
_GRAVITY = "g", ""


@cache
def _rows() -> list[str]:
    text = Path(__file__).parents[1].joinpath("appendix.txt").read_text(encoding="utf-8")
    return ["".join(row.split()) for row in re.split(r"^\[.*\]$", text, flags=re.MULTILINE)[1:]]


def elements(row: str) -> dict[str, str]:
    """Return a torque's groups by name, and their sum with their motions as "tau", from its text without spaces."""
    groups: _Groups = {}
    pending: list[str] = []
    place, opened = 0, False

    def flush(group: tuple[str, str], count: int) -> None:
        if count:
            groups.setdefault(group, []).extend(pending[-count:])
            del pending[-count:]

    while place < len(row):
        if factor := _FACTOR.match(row, place):
            in_brackets = factor["bracket"] or opened
            flush(_group(factor), len(pending) if in_brackets else 1)
            opened = opened and not in_brackets
            place = factor.end()
        elif opening := _OPENING.match(row, place):
            flush(_GRAVITY, len(pending))
            place, opened = opening.end(), True
        elif (term := _TERM.match(row, place)) and (term[2] or term[3]) and (term[1] or not pending):
            pending.append(_signed(term[0]))
            place = term.end()
        else:
            place += 1  # the sign before a lost bracket, or a character that is left out
    flush(_GRAVITY, len(pending))
    sums = {name: " ".join(texts).removeprefix("+ ") for (name, _), texts in groups.items()}
    return sums | {"tau": " + ".join(map("".join, groups))}


def _group(factor: re.Match[str]) -> tuple[str, str]:
    """Return the name and the motion of the group that a factor ends."""
    names = [factor[key] for key in ("first", "second") if factor[key]]
    velocity = "v" in "".join(names) or factor["square"] or len(names) == 2
    joints = [name[-1] for name in names]
    motion = "".join(f"*{'dq' if velocity else 'ddq'}{joint}" for joint in joints) + (factor["square"] or "")
    return (f"h_{joints[0]}{joints[-1]}" if velocity else f"a_{joints[0]}"), motion


def _signed(term: str) -> str:
    """Return a term with its sign before it, and with product signs in its argument put right."""
    body = re.sub(r"([-+])\*q", r"\1q", re.sub(r"(\d)q", r"\1*q", term.lstrip("+-")))
    return f"{'-' if term.startswith('-') else '+'} {body}"


def _read(torque: int) -> dict[str, str]:
    found = elements(_rows()[torque - 1])
    return {(f"tau_{torque}" if name == "tau" else name): text for name, text in found.items()}


read_1, read_2, read_3, read_4, read_5, read_6 = (partial(_read, torque) for torque in range(1, 7))
