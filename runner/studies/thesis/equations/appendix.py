"""Equations of motion of the six-joint arm in the thesis' appendix, parsed and counted term by term.

The appendix writes each torque as a sum of groups, "(sum of terms) * product of velocities" or "... * acceleration",
and of gravity terms. A term is a fraction times the sine or cosine of a sum of joint positions. Some of the text is
damaged; it is parsed as it is, and every emendation is recorded.
"""

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path

JOINTS = 6

_TERM = re.compile(r"([+-]?)(?:(\d+(?:/\d+)?)(?:\*(?=[sc]))?)?(?:(sin|cos)\(([-+*\dq]*)\))?")
_OPENING = re.compile(r"[+-]?\(")
_FACTOR = re.compile(r"(\)?)\*(q[va]?\^?\d)(\^2)?(?:\*(q[va]?\^?\d))?(?![\d^])")
_POSITION = re.compile(r"([+-]?)(\d?)(\*?)q(\d)")


@dataclass(frozen=True)
class Harmonic:
    """A sine or cosine of a sum of joint positions, in a form that is the same for equal functions.

    Attributes:
        function: "sin" or "cos"; a constant is the cosine of nothing.
        multiples: How often each joint position stands in the sum; the first that is not 0 is positive.
    """

    function: str
    multiples: tuple[int, ...]


@dataclass(frozen=True)
class Term:
    """One term as it has been read.

    Attributes:
        torque: The row it stands in, 1 to 6.
        factor: The product of velocities, or the acceleration, that its group is multiplied with: "qv1*qv2", "qv3^2"
            or "qa1"; "gravity" where there is none.
        harmonic: Its function of the joint positions.
        coefficient: What that is multiplied with, in N m, kg m^2 or N m s^2.
        text: As it stands.
    """

    torque: int
    factor: str
    harmonic: Harmonic
    coefficient: Fraction
    text: str


@dataclass(frozen=True)
class Emendation:
    """A place in a torque's row where the text as it stands cannot be read, and what kind of emendation was done."""

    torque: int
    kind: str
    text: str


@dataclass(frozen=True)
class Appendix:
    """The appendix as read: its terms in order, and what was emended to read them."""

    terms: tuple[Term, ...]
    emendations: tuple[Emendation, ...]


@cache
def read_appendix() -> Appendix:
    """Return the appendix of the thesis as its text stands."""
    rows: list[str] = []
    for line in Path(__file__).with_name("appendix.txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            rows.append("")
        elif rows:
            rows[-1] += line.strip()
    return parse(rows)


def parse(rows: list[str]) -> Appendix:
    """Return the terms of the rows' texts, one row a torque.

    Four kinds of damage are emended, and recorded: a lost bracket of a group (it is taken to begin after the group
    before it, or to end before its factor), a factor without the letter v or a ("q3^2" in the place of a factor is a
    velocity, a lone "q1" an acceleration), a number raised ("qv^2" for qv2, which is no power), and a missing product
    sign. Anything else that cannot be read is left out, and recorded as "unreadable".
    """
    terms: list[Term] = []
    emendations: list[Emendation] = []
    for torque, text in enumerate(rows, start=1):
        _Row(torque, text, terms, emendations).read()
    return Appendix(tuple(terms), tuple(emendations))


class _Row:
    def __init__(self, torque: int, text: str, terms: list[Term], emendations: list[Emendation]) -> None:
        self._torque, self._text, self._terms, self._emendations = torque, text, terms, emendations
        self._pending: list[tuple[Harmonic, Fraction, str]] = []
        self._open = False

    def read(self) -> None:
        place = 0
        while place < len(self._text):
            if factor := _FACTOR.match(self._text, place):
                self._close(factor)
                place = factor.end()
            elif opening := _OPENING.match(self._text, place):
                self._flush(self._pending, "gravity")
                self._open = True
                place = opening.end()
            elif (term := _TERM.match(self._text, place)) and (term[2] or term[3]) and (term[1] or not self._pending):
                self._pending.append(self._term(term))
                place = term.end()
            else:
                if self._text[place] != "+":  # the sign before a bracket that is lost
                    self._emend("unreadable", place)
                place += 1
        self._flush(self._pending, "gravity")

    def _term(self, match: re.Match[str]) -> tuple[Harmonic, Fraction, str]:
        sign, coefficient, function, argument = match.groups()
        value = Fraction(coefficient or 1) * (-1 if sign == "-" else 1)
        multiples = [0] * JOINTS
        for minus, count, product, joint in _POSITION.findall(argument or ""):
            multiples[int(joint) - 1] += int(count or 1) * (-1 if minus == "-" else 1)
            if count and not product:
                self._emend("product sign put in", match.start())
        return *canonical(function or "cos", tuple(multiples), value), match[0]

    def _close(self, match: re.Match[str]) -> None:
        bracket, first, square, second = match.groups()
        names = [name for name in (first, second) if name]
        if any("^" in name for name in names):
            self._emend("raised number put down", match.start())
        if any(name[1].isdigit() for name in names):
            self._emend("v or a put in", match.start())
            letter = "qv" if square or second else "qa"
            names = [letter + name[1:] if name[1].isdigit() else name for name in names]
        factor = "*".join(name.replace("^", "") for name in names) + (square or "")
        if not bracket and not self._open:  # it belongs to the last term alone
            self._flush([self._pending.pop()], factor)
            return
        if not (bracket and self._open):
            self._emend("bracket put in", match.start())
        self._flush(self._pending, factor)
        self._open = False

    def _flush(self, pending: list[tuple[Harmonic, Fraction, str]], factor: str) -> None:
        self._terms += [Term(self._torque, factor, *term) for term in pending]
        pending.clear()

    def _emend(self, kind: str, place: int) -> None:
        self._emendations.append(Emendation(self._torque, kind, self._text[max(0, place - 20) : place + 20]))


def canonical(function: str, multiples: tuple[int, ...], value: Fraction) -> tuple[Harmonic, Fraction]:
    """Return a harmonic and its coefficient such that equal functions are equal: sin(-x) is -sin(x)."""
    first = next((multiple for multiple in multiples if multiple), 0)
    if first < 0:
        multiples = tuple(-multiple for multiple in multiples)
        value = -value if function == "sin" else value
    return Harmonic(function, multiples), value
