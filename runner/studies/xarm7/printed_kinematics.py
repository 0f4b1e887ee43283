"""Formulas of the xArm7 report from its audited equations: P_e, and q1, q2 and q4 of its inverse."""

from collections.abc import Collection, Mapping
from functools import cache

import numpy as np

from runner.audit.entry import Entry, entries
from runner.audit.evaluation import evaluate
from runner.base.arrays import FloatArray
from runner.base.expressions.parser import parse
from runner.robots.model import RobotModel
from runner.studies.xarm7.equations.truths.xarm7 import JOINTS, constants

CENTIMETRES = 100.0
"""What one metre is in the report's unit of length."""
_TIP = ("P_ex", "P_ey", "P_ez")
_INVERSE = ("q1", "p1", "p2", "M", "q4", "p3", "p4", "q2")  # in the order in which each takes those before it
_LENGTHS = ("l1", "l2", "l3", "l4", "l5")


@cache
def _entries() -> Mapping[str, Entry]:
    return {entry.number: entry for _, entry in entries("xarm7")}


def _value(name: str, right: bool, values: Mapping[str, FloatArray]) -> FloatArray:
    """Return a formula's value as printed, or put right where it is wrong."""
    entry = _entries()[name]
    form = (entry.corrected if right else None) or entry.repair or entry.printed
    return evaluate(parse(form.elements[name]), values)


def printed_tip(q: FloatArray, right: bool) -> FloatArray:
    """Return P_e at rows of joint positions, shapes (N, 7) in rad to (N, 3) in m.

    As printed q1, q5 and q2 stand where theta1 and theta2 do if it is put right, as in A14, A24 and A34.
    """
    values = constants(len(q)) | {f"q{joint + 1}": q[:, joint] for joint in range(JOINTS)}
    return np.stack([_value(name, right, values) for name in _TIP], axis=1) / CENTIMETRES


def printed_inverse(
    tips: FloatArray, wrist: float, right: Collection[str] = (), unit: float = CENTIMETRES
) -> FloatArray:
    """Return q1, q2 and q4 for tips in m by the printed formulas, shape (N, 3), in rad ("inverse kinematic control").

    q2 and q4 may be put `right`: the sign in q2's denominator, M^2 inside the root of q4. M^2 outside the root makes
    the unit of length count: `unit` is what one metre is in it.
    """
    values = constants(len(tips)) | {"q6": np.full(len(tips), wrist)}
    values |= {name: values[name] * unit / CENTIMETRES for name in _LENGTHS}
    values |= dict(zip(_TIP, unit * tips.T, strict=True))
    for name in _INVERSE:
        values[name] = _value(name, name in right, values)
    return np.stack([values[name] for name in ("q1", "q2", "q4")], axis=1)


def random_postures(model: RobotModel, count: int, seed: int = 0) -> FloatArray:
    """Return postures spread evenly over the joint limits, shape (count, nq), in rad; always the same ones."""
    low, high = model.position_limits
    return np.random.default_rng(seed).uniform(low, high, (count, model.nq))
