r"""Friction of a joint as columns of a linear model, for each kind that can be fitted.

.. math::

    \tau_f = b\, v + c\, \mathrm{sgn}\, v + o + \begin{cases} k\, |\tau_l|\, \mathrm{sgn}\, v & \text{load} \\
    s\, e^{-|v| / v_s} \mathrm{sgn}\, v & \text{stribeck} \end{cases}

with the load tau_l of links and rotor. The kind `sigmoid` has c tanh(v / v_s) instead of c sgn v. The first, third and
fourth kind are those of `plant.friction`. Coulomb friction that grows with the load is that of gears (Duclusaud et al.,
IEEE ICRA 2025).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from runner.base.arrays import FloatArray

FrictionKind = Literal["coulomb", "sigmoid", "load", "stribeck"]
KINDS: tuple[FrictionKind, ...] = get_args(FrictionKind)
"""All kinds, those with fewer terms first."""

TERMS: dict[FrictionKind, tuple[str, ...]] = {
    "coulomb": ("viscous", "coulomb", "offset"),
    "load": ("viscous", "coulomb", "offset", "coulomb by load"),
    "stribeck": ("viscous", "coulomb", "offset", "stribeck"),
    "sigmoid": ("viscous", "sigmoid", "offset"),
}
"""Names of the columns of each kind."""

SHAPES = (0.05, 0.08, 0.12, 0.2, 0.3)
"""Values of v_s that are tried, as shares of a joint's largest speed."""

WORDS: dict[FrictionKind, str] = {
    "coulomb": "viscous and Coulomb friction",
    "load": "viscous friction, and Coulomb friction that grows with the load",
    "stribeck": "viscous friction, and Coulomb friction that falls with speed (Stribeck)",
    "sigmoid": "viscous friction, and a sigmoid over speed",
}
SHAPED: tuple[FrictionKind, ...] = ("stribeck", "sigmoid")
"""Kinds with a speed v_s that the columns depend on."""


@dataclass(frozen=True)
class JointSpeeds:
    """What friction of a joint depends on, at the rows before the low-pass.

    Attributes:
        v: Speed, shape (N,), in rad/s.
        sign: Direction of motion, shape (N,).
        load: Magnitude of the torque of links and rotor, shape (N,), in N m.
        fastest: Largest speed, in rad/s.
    """

    v: FloatArray
    sign: FloatArray
    load: FloatArray
    fastest: float


def friction_columns(kind: FrictionKind, at: JointSpeeds, shape: float) -> FloatArray:
    """Return the columns of a kind, in the order of TERMS, shape (N, n).

    Args:
        kind: The kind.
        at: What friction depends on.
        shape: v_s as a share of the largest speed.
    """
    v, sign, one = at.v, at.sign, np.ones(len(at.v))
    share = v / max(shape * at.fastest, 1e-12)
    if kind == "sigmoid":
        return np.column_stack([v, np.tanh(share), one])
    columns = [v, sign, one]
    if kind == "load":
        columns.append(at.load * sign)
    if kind == "stribeck":
        columns.append(np.exp(-np.abs(share)) * sign)
    return np.column_stack(columns)


def other_columns(kind: FrictionKind, at: JointSpeeds) -> dict[str, FloatArray]:
    """Return columns that a kind lacks, by their words: what is left over must not follow them."""
    found = {
        "the load": at.load * at.sign,
        "low speed": np.exp(-np.abs(at.v) / max(0.1 * at.fastest, 1e-12)) * at.sign,
        "the square of speed": at.v * np.abs(at.v),
    }
    if kind == "load":
        del found["the load"]
    if kind == "stribeck":
        del found["low speed"]
    if kind == "sigmoid":
        found["the direction"] = at.sign
        del found["low speed"]
    return found


def term_unit(term: str, prismatic: bool) -> str:
    """Return the unit of the coefficient of a term."""
    if term == "viscous":
        return "N s/m" if prismatic else "N m s/rad"
    if term == "coulomb by load":
        return "1"
    return "N" if prismatic else "N m"


def friction_at_rest(kind: FrictionKind, values: Sequence[float], load: FloatArray) -> FloatArray:
    """Return the largest friction that can hold a joint at rest, shape (N,), in N m."""
    found = dict(zip(TERMS[kind], values, strict=True))
    held = found.get("coulomb", found.get("sigmoid", 0.0)) + found.get("stribeck", 0.0)
    level: FloatArray = np.abs(held + found.get("coulomb by load", 0.0) * load)
    return level
