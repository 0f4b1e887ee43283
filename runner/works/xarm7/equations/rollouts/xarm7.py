"""The xArm7 on the report's own line, 40 cm along y, by the printed formulas and by the right ones. Lengths in cm."""

from collections.abc import Callable

import numpy as np

from runner.audit.entry import entries
from runner.audit.evaluation import evaluate
from runner.audit.expressions import parse
from runner.audit.rollout import Rollout
from runner.audit.truth import FloatArray
from runner.works.xarm7.equations.truths.xarm7 import (
    JOINTS,
    constants,
    left_inverse_of,
    model_jacobians,
    model_poses,
    pose,
    printed_jacobians,
)
from runner.works.xarm7.equations.truths.xarm7_claims import ENDS, points, solve
from runner.works.xarm7.equations.truths.xarm7_inverse import full

_POINTS = 201
_DURATION = 4.0  # s
_STEP = 0.01  # s
_FASTEST = np.pi  # rad/s, the arm's limit
_LOST = 1e3  # rad/s, where a run is given up

Inverse = Callable[[FloatArray], FloatArray]


def tip_formula() -> Rollout:
    """Return where the printed P_e says that the tip is, on the line."""
    y = np.linspace(*ENDS, _POINTS)
    q = full(solve(points(y)))
    symbols = {f"q{i + 1}": q[:, i] for i in range(JOINTS)} | constants(_POINTS)
    forms = {entry.number: entry for _, entry in entries("xarm7") if entry.number in ("P_ex", "P_ey", "P_ez")}
    printed = [(entry.repair or entry.printed).elements[name] for name, entry in sorted(forms.items())]
    said = np.column_stack([evaluate(parse(text), symbols) for text in printed])
    error = np.linalg.norm(said - points(y), axis=1)
    return Rollout(
        "The printed tip position along the line",
        f"With the tip on the report's line the printed formulas place it {error.min():.1f} to {error.max():.1f} cm "
        "away. A controller that closes its loop on them drives there.",
        "y of the tip (cm)",
        "tip, computed to real (cm)",
        y,
        {"as printed": error, "corrected": np.linalg.norm(pose(q)[:, :3, 3] - points(y), axis=1)},
    )


def line_by_inverse() -> Rollout:
    """Return where the tip goes with the printed q2, the printed q4 and the right ones."""
    y = np.linspace(*ENDS, _POINTS)
    target = points(y)

    def missed(q2_sign: float, root: bool) -> FloatArray:
        tip = model_poses(full(solve(target, q2_sign=q2_sign, root=root)))[:, :3, 3]
        return np.asarray(np.linalg.norm(tip - target, axis=1))

    curves = {
        "q2 as printed": missed(-1.0, True),
        "q4 as printed": missed(1.0, False),
        "both as printed": missed(-1.0, False),
        "corrected": missed(1.0, True),
    }
    return Rollout(
        "The line by the printed inverse kinematics",
        f"The tip misses the line by {curves['q2 as printed'].max():.1f} cm at worst with q2 as printed, by "
        f"{curves['q4 as printed'].max():.1f} cm with q4 as printed, by {curves['both as printed'].max():.1f} cm with "
        f"both, and by {_centimetres(curves['corrected'].max())} corrected. The report's figures show the line "
        "followed: its program did not contain these two equations as they stand.",
        "y of the target (cm)",
        "tip to target (cm)",
        y,
        curves,
    )


def resolved_rate() -> Rollout:
    """Return the line by joint rates J+ times the velocity, with the printed columns and the right ones."""
    times = np.arange(0, _DURATION + _STEP / 2, _STEP)
    printed, right = _follow(lambda q: np.linalg.pinv(printed_jacobians(q[None])[0])), _follow(_right_inverse)
    return Rollout(
        "The line by joint rates, with the printed Jacobian",
        f"Joint rates from the pseudo-inverse, from A to B in {_DURATION:.0f} s, the attitude held. With the printed "
        "columns (their angles mended, so that the shift by one joint alone is seen) the tip ends "
        f"{printed[0][-1]:.1f} cm from B; with the right ones {right[0][-1]:.3f} cm, the error of the time step.",
        "time (s)",
        "tip to target (cm)",
        times,
        {"columns as printed": printed[0], "corrected": right[0]},
    )


def left_inverse() -> Rollout:
    """Return the joint rates that (J' J)^-1 J' asks for, and those of the right form."""
    times = np.arange(0, _DURATION + _STEP / 2, _STEP)
    printed, right = _follow(left_inverse_of), _follow(_right_inverse)
    beyond = np.flatnonzero(~(printed[1] <= _FASTEST))
    when = f"first at {times[beyond[0]]:.2f} s" if len(beyond) else "at no time"
    return Rollout(
        "The line by joint rates, with the printed pseudo-inverse",
        f"The same line with the right Jacobian and the printed inverse of $J^T J$, a matrix of rank 6 at most. The "
        f"fastest joint exceeds its limit of 180 degrees per second {when}; rates above {_LOST:.0f} rad/s end the "
        f"run. The right form needs {np.nanmax(right[1]):.2f} rad/s.",
        "time (s)",
        "fastest joint (rad/s)",
        times,
        {"as printed": printed[1], "corrected": right[1]},
        logarithmic=True,
    )


def _right_inverse(q: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.pinv(model_jacobians(q[None])[0]))


def _follow(inverse: Inverse) -> tuple[FloatArray, FloatArray]:
    """Follow the line at constant speed by joint rates alone.

    Args:
        inverse: Joint rates for a twist, shape (7, 6), at joint positions, shape (7,).

    Returns:
        Distance of the tip from its target, in cm, and the fastest joint, in rad/s, at each instant; NaN after the end.
    """
    count = round(_DURATION / _STEP) + 1
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


def _centimetres(distance: float) -> str:
    """Return a distance in cm, or that it is what rounding leaves."""
    return f"{distance:.1f} cm" if distance > 1e-9 else "0 (rounding)"
