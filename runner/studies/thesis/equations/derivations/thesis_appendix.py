"""Thesis appendix compared with the true dynamics of the six-joint arm, by torque and term.

The torques of such a chain are trigonometric polynomials in the joint positions, times products of two velocities or
an acceleration. The model evaluates them on a sufficiently fine grid. A discrete Fourier transform gives their
coefficients, the true values of the printed terms.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement, product

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel
from runner.studies.thesis.equations.appendix import JOINTS, Appendix, Harmonic, Term, read_appendix
from runner.studies.thesis.equations.derivations.thesis_arms import COMBINED

_POINTS = 5  # along each joint position: a harmonic of at most twice the angle needs 2 * 2 + 1
_TOLERANCE = 1e-9  # of a coefficient; the smallest that is not zero is 1/32000
_DENOMINATOR = 1_000_000  # more than the largest of a true coefficient
_TORQUES = range(1, JOINTS + 1)
_WRITTEN = re.compile(r"([+-]) (\d+(?:/\d+)?)(.*)")

Series = dict[tuple[int, str], dict[Harmonic, float]]
"""True coefficients by torque (1 to 6), factor of the group, and harmonic."""


@dataclass(frozen=True)
class Damage:
    """A term of a torque's group as read, None where it is lost, and the true harmonic, None for nothing."""

    torque: int
    factor: str
    read: Term | None
    harmonic: Harmonic | None
    true: Fraction

    @property
    def kind(self) -> str:
        """What is damaged: a coefficient, the argument of the function, or the whole term, which is lost."""
        if self.read is None:
            return "lost"
        return "coefficient" if self.read.harmonic == self.harmonic else "argument"


# True coefficients.


@cache
def true_series() -> Series:
    """Return the true coefficients of the torques; nothing depends on joint 1's position, as its axis is vertical."""
    model = COMBINED.model
    angles = 2.0 * np.pi * np.arange(_POINTS) / _POINTS
    grid = np.array([(0.0, *point) for point in product(angles, repeat=JOINTS - 1)])
    samples = np.array([_coefficients(model, q) for q in grid])  # (grid, factors, joints)
    shape = (_POINTS,) * (JOINTS - 1)
    spectrum = np.fft.fftn(samples.reshape(*shape, *samples.shape[1:]), axes=range(JOINTS - 1)) / len(grid)
    series: Series = {}
    for place in np.argwhere(np.abs(spectrum) > _TOLERANCE):
        multiples = (0, *(int((k + 2) % _POINTS) - 2 for k in place[: JOINTS - 1]))
        if next((multiple for multiple in multiples if multiple), 0) < 0:
            continue  # its conjugate says the same
        amplitude = spectrum[tuple(place)] * (2.0 if any(multiples) else 1.0)
        found = series.setdefault((int(place[-1]) + 1, _factors()[place[-2]]), {})
        for function, coefficient in (("cos", amplitude.real), ("sin", -amplitude.imag)):
            if abs(coefficient) > _TOLERANCE:
                found[Harmonic(function, multiples)] = float(coefficient)
    return series


def _factors() -> list[str]:
    """Return what a group may be multiplied with: gravity's nothing, six accelerations, 21 products of velocities."""
    pairs = combinations_with_replacement(_TORQUES, 2)
    products = [f"qv{i}^2" if i == j else f"qv{i}*qv{j}" for i, j in pairs]
    return ["gravity", *(f"qa{i}" for i in _TORQUES), *products]


def _coefficients(model: RobotModel, q: FloatArray) -> FloatArray:
    """Return what the factors are multiplied with in the six torques at a posture, shape (factors, joints)."""
    unit = np.eye(JOINTS)
    squares = [model.coriolis_torque(q, e) for e in unit]
    products = [
        squares[i] if i == j else model.coriolis_torque(q, unit[i] + unit[j]) - squares[i] - squares[j]
        for i, j in combinations_with_replacement(range(JOINTS), 2)
    ]
    return np.array([model.gravity_torque(q), *model.mass_matrix(q), *products])


# Comparison.


def damages(appendix: Appendix, series: Series) -> list[Damage]:
    """Return where the appendix differs from the true coefficients.

    A printed term is right when the true group has its function with its coefficient; each true term is taken once.
    Of the others, one whose function the true group has is damaged in its coefficient, and one whose function it has
    not is damaged in its argument: it is matched to a true term left over in its group with the same coefficient.
    """
    left = {key: dict(terms) for key, terms in series.items()}
    doubtful = [term for term in appendix.terms if not _take(left.get((term.torque, term.factor), {}), term)]
    found: list[Damage] = []
    strangers: list[Term] = []
    for term in doubtful:
        group = left.get((term.torque, term.factor), {})
        if term.harmonic in group:
            found.append(Damage(term.torque, term.factor, term, term.harmonic, _fraction(group.pop(term.harmonic))))
        else:
            strangers.append(term)
    for term in strangers:
        group = left.get((term.torque, term.factor), {})
        size = abs(float(term.coefficient))
        harmonic = next((h for h, value in group.items() if abs(abs(value) - size) < _TOLERANCE), None)
        true = _fraction(group.pop(harmonic)) if harmonic else Fraction(0)
        found.append(Damage(term.torque, term.factor, term, harmonic, true))
    lost = [(*key, *item) for key, group in left.items() for item in group.items()]
    return found + [Damage(torque, factor, None, h, _fraction(value)) for torque, factor, h, value in lost]


def _take(group: dict[Harmonic, float], term: Term) -> bool:
    right = term.harmonic in group and abs(group[term.harmonic] - float(term.coefficient)) < _TOLERANCE
    if right:
        del group[term.harmonic]
    return right


def _fraction(value: float) -> Fraction:
    return Fraction(value).limit_denominator(_DENOMINATOR)


@cache
def appendix_damages() -> tuple[Damage, ...]:
    """Return where the appendix as read differs from the true coefficients."""
    return tuple(damages(read_appendix(), true_series()))


# The six torques as expressions: `h_12` is what dq1 dq2 is multiplied with, `a_1` what ddq1 is, `g` is gravity.


def _as_read(torque: int) -> Callable[[], dict[str, str]]:
    """Return a torque by its terms as they have been read."""
    return lambda: _equations(torque, [(term.factor, _text(term)) for term in _terms(torque)])


def _emended(torque: int) -> Callable[[], dict[str, str]]:
    """Return a torque by its terms with the damaged ones emended, and the lost ones put in."""

    def equations() -> dict[str, str]:
        found = [each for each in appendix_damages() if each.torque == torque]
        emended = {id(each.read): _true_text(each) for each in found}
        whole = [(term.factor, emended.get(id(term), _text(term))) for term in _terms(torque)]
        return _equations(torque, whole + [(each.factor, _true_text(each)) for each in found if each.read is None])

    return equations


def _terms(torque: int) -> list[Term]:
    return [term for term in read_appendix().terms if term.torque == torque]


def _equations(torque: int, terms: list[tuple[str, str]]) -> dict[str, str]:
    groups: dict[str, list[str]] = {}
    for factor, text in terms:
        groups.setdefault(factor, []).append(text)
    sums = {_name(factor): " ".join(texts).strip().removeprefix("+ ") for factor, texts in groups.items()}
    return sums | {f"tau_{torque}": " + ".join(_name(factor) + _motion(factor) for factor in groups)}


def _name(factor: str) -> str:
    joints = re.findall(r"q[va](\d)", factor)
    if not joints:
        return "g"
    return f"a_{joints[0]}" if factor.startswith("qa") else f"h_{joints[0]}{joints[-1]}"


def _motion(factor: str) -> str:
    return "" if factor == "gravity" else "*" + factor.replace("qv", "dq").replace("qa", "ddq")


def _text(term: Term) -> str:
    """Return a term as it stands, with its sign before it and product signs that are lost or stray put right."""
    body = re.sub(r"([-+])\*q", r"\1q", re.sub(r"(\d)q", r"\1*q", term.text.lstrip("+-")))
    return f"{'-' if term.text.startswith('-') else '+'} {body}"


def _true_text(damage: Damage) -> str:
    """Return what must stand in a damaged place; nothing where no term does."""
    if damage.harmonic is None:
        return ""
    signed = [(count, f"q{joint}") for joint, count in enumerate(damage.harmonic.multiples, start=1) if count]
    angle = " ".join(f"{'-' if n < 0 else '+'} {f'{abs(n)}*' if abs(n) > 1 else ''}{q}" for n, q in signed)
    value, function = damage.true, f"*{damage.harmonic.function}({angle.removeprefix('+ ')})" if signed else ""
    if damage.read is not None and damage.kind == "coefficient":
        match = _WRITTEN.fullmatch(_text(damage.read))
        sign, coefficient, function = match.groups() if match else ("+", "1", function)
        value *= damage.read.coefficient / Fraction(f"{sign}{coefficient}")  # -1 if its argument has the other sign
    return f"{'-' if value < 0 else '+'} {abs(value)}{function}"


read_1, read_2, read_3, read_4, read_5, read_6 = (_as_read(torque) for torque in _TORQUES)
emended_1, emended_2, emended_3, emended_4, emended_5, emended_6 = (_emended(torque) for torque in _TORQUES)
