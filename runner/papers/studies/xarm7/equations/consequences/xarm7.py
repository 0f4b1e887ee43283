"""Motion of the xArm7 on the report's 40 cm line along y, under printed and correct formulas. Lengths in cm."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.consequence import Consequence
from runner.papers.studies.xarm7.equations.derivations.xarm7 import (
    BY_MODEL,
    left_inverse_of,
    pose,
    printed_jacobians,
)
from runner.papers.studies.xarm7.equations.derivations.xarm7_inverse import (
    CENTIMETRES,
    ENDS,
    full,
    points,
    printed_tip,
    solve,
)

_POINTS = 201
_DURATION = 4.0  # s
_STEP = 0.01  # s
_TIMES = np.arange(0, _DURATION + _STEP / 2, _STEP)
_FASTEST = np.pi  # rad/s, the arm's limit
_LOST = 1e3  # rad/s, where a run is given up

Inverse = Callable[[FloatArray], FloatArray]


def tip_formula() -> Consequence:
    """Return the error of the tip's position by the printed P_e, on the line."""
    y = np.linspace(*ENDS, _POINTS)
    q = full(solve(points(y)))
    error = np.linalg.norm(CENTIMETRES * printed_tip(q, right=False) - points(y), axis=1)
    right = np.linalg.norm(pose(q)[:, :3, 3] - points(y), axis=1)
    return Consequence(y, {"as printed": error, "corrected": right})


def line_by_inverse() -> Consequence:
    """Return the tip's errors with the printed q2, the printed q4 and the right ones."""
    y = np.linspace(*ENDS, _POINTS)
    target = points(y)

    def missed(sign: bool, root: bool) -> FloatArray:
        tip = BY_MODEL.pose(full(solve(target, sign=sign, root=root)))[:, :3, 3]
        return np.asarray(np.linalg.norm(tip - target, axis=1))

    curves = {
        "q2 as printed": missed(False, True),
        "q4 as printed": missed(True, False),
        "both as printed": missed(False, False),
        "corrected": missed(True, True),
    }
    right = curves["corrected"].max()
    return Consequence(y, curves, {"corrected": f"{right:.1f} cm" if right > 1e-9 else "0 (rounding)"})


def resolved_rate() -> Consequence:
    """Return the line by joint rates J+ times the velocity, with the printed columns and the right ones."""
    printed, right = _follow(lambda q: np.linalg.pinv(printed_jacobians(q[None])[0])), _follow(_right_inverse)
    return Consequence(_TIMES, {"columns as printed": printed[0], "corrected": right[0]}, {"duration": _DURATION})


def left_inverse() -> Consequence:
    """Return the joint rates that (J' J)^-1 J' asks for, and those of the right form."""
    printed, right = _follow(left_inverse_of), _follow(_right_inverse)
    beyond = bool((printed[1] > _FASTEST).any())  # when it is, and by how much, follows from rounding errors
    numbers = {"exceeds": "exceeds" if beyond else "keeps", "lost": _LOST}
    return Consequence(_TIMES, {"as printed": printed[1], "corrected": right[1]}, numbers)


def _right_inverse(q: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.pinv(BY_MODEL.jacobian(q[None])[0]))


def _follow(inverse: Inverse) -> tuple[FloatArray, FloatArray]:
    """Follow the line at constant speed only by joint rates, the inverse times the twist.

    Return the tip's distance from its target, in cm, and the fastest joint, in rad/s, in time; NaN after the end.
    """
    count = len(_TIMES)
    y = np.linspace(*ENDS, count)
    twist = np.array([0, (ENDS[1] - ENDS[0]) / _DURATION, 0, 0, 0, 0])
    distance, fastest = np.full(count, np.nan), np.full(count, np.nan)
    q = full(solve(points(y[:1])))[0]
    for i, target in enumerate(points(y)):
        rates = inverse(q) @ twist
        distance[i] = np.linalg.norm(pose(q[None])[0, :3, 3] - target)
        fastest[i] = np.abs(rates).max()
        if not fastest[i] <= _LOST:
            break
        q = q + _STEP * rates
    return distance, fastest
