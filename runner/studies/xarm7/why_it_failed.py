"""Errors in the report's second part: inverse, Jacobian, and their effect on the motion."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import above_rounding, number
from runner.reporting.document import Series
from runner.robots.model import RobotModel
from runner.store import Run
from runner.studies.xarm7.figures import ROWS, line_length, smallest_margin
from runner.studies.xarm7.kinematics import random_postures
from runner.studies.xarm7.parts.xarm7_as_printed import PrintedJacobian
from runner.study.results import Runs, found

_COUNT, _SEED = 1000, 7  # of the random postures
_ZERO = 7  # palette index of singular values that are zero except for rounding
_METRICS = ("max_axis_error", "cross_track_error", "peak_joint_speed")


@dataclass(frozen=True)
class Inversion:
    """Properties of (J^T J)^-1 J^T over some postures.

    Attributes:
        ranks: Rank of J^T J at each posture, shape (N,).
        offs: |J X - 1|, X instead of J^+, if NumPy does not refuse to invert it; spectral norm, zero of J^+.
        right: The same of J^T (J J^T)^-1 at every posture, shape (N,).
    """

    ranks: FloatArray
    offs: FloatArray
    right: FloatArray


def invert(jacobians: FloatArray) -> Inversion:
    """Take the printed pseudo-inverse of each of some Jacobians, shape (N, m, n), by NumPy."""
    unit = np.eye(jacobians.shape[1])
    offs: list[float] = []
    for J in jacobians:
        with suppress(np.linalg.LinAlgError):
            offs.append(float(np.linalg.norm(J @ (np.linalg.inv(J.T @ J) @ J.T) - unit, 2)))
    transposed = jacobians.transpose(0, 2, 1)
    right = transposed @ np.linalg.inv(jacobians @ transposed)
    return Inversion(
        np.linalg.matrix_rank(transposed @ jacobians).astype(float),
        np.array(offs),
        np.linalg.norm(jacobians @ right - unit, 2, axis=(1, 2)),
    )


def inversions(runs: Runs) -> dict[tuple[str, str], Inversion]:
    """Return the inversions by the tip's task and by the kind of postures: random, or on the line."""
    model = runs["printed/position/working"].model
    everywhere = _true(model, random_postures(model, _COUNT, _SEED))
    return {
        (task, where): invert(jacobians[:, :rows])
        for task, rows in ROWS.items()
        for where, jacobians in (("random", everywhere), ("line", _along(runs, task)))
    }


def inverse_rows(tried: Mapping[tuple[str, str], Inversion]) -> list[list[str]]:
    """Return the same as rows of a table."""
    rows = []
    for (task, where), result in tried.items():
        low, high = (f"{value:.0f}" for value in (result.ranks.min(), result.ranks.max()))
        answers = [number(float(of(result.offs)), 2) for of in (np.median, np.max) if result.offs.size]
        rows.append(
            [
                f"{ROWS[task]} × 7",
                f"{result.right.size}, {where}",
                f"{low} of 7" if low == high else f"{low} to {high} of 7",
                str(result.right.size - result.offs.size),
                f"{answers[0]} (up to {answers[1]})" if answers else "–",
                above_rounding(float(result.right.max()), digits=2),
            ]
        )
    return rows


def inverse_values(tried: Mapping[tuple[str, str], Inversion]) -> dict[str, float | None]:
    """Return their summary: cases, those refused, rank beyond J's rows, |J X - 1| of printed and right."""
    results = tried.values()
    answers, cases = np.concatenate([result.offs for result in results]), sum(result.right.size for result in results)
    return {
        "cases": cases,
        "refused": cases - answers.size,
        "surplus": max(float(result.ranks.max()) - ROWS[task] for (task, _), result in tried.items()),
        "median": float(np.median(answers)) if answers.size else None,
        "best": float(answers.min()) if answers.size else None,
        "right": float(max(result.right.max() for result in results)),
    }


def singular_values(runs: Runs, task: str) -> list[Series]:
    """Return the singular values of J^T J of the right Jacobian along the line, over the tip's y in m."""
    rows, run = ROWS[task], runs[f"printed/{task}/working"]
    J = _along(runs, task)[:, :rows]
    values = np.linalg.svd(J.transpose(0, 2, 1) @ J, compute_uv=False)
    names = [*(f"singular value {k + 1}" for k in range(rows)), "zero, rounded", *[""] * (6 - rows)]
    return [
        Series(name, _y(run), own, "line" if k < rows else "dotted", color=k if k < rows else _ZERO)
        for k, (name, own) in enumerate(zip(names, values.T, strict=True))
    ]


def least_true_value(runs: Runs) -> float:
    """Return the least of the singular values of J^T J along the line, of both tasks, that J's rows account for."""
    return min(float(np.min(each.y)) for each in _all_singular_values(runs) if each.style == "line")


def largest_rounded_value(runs: Runs) -> float:
    """Return the largest of the others, which are zero except for rounding."""
    return max(float(np.max(each.y)) for each in _all_singular_values(runs) if each.style != "line")


def _all_singular_values(runs: Runs) -> list[Series]:
    return [series for task in ROWS for series in singular_values(runs, task)]


def _along(runs: Runs, task: str) -> FloatArray:
    """Return the right Jacobians along the line, from A to B, shape (N, 6, 7)."""
    run = runs[f"printed/{task}/working"]
    return _true(run.model, run.joints("q")[_to_b(run)])


def _true(model: RobotModel, postures: FloatArray) -> FloatArray:
    return np.array([model.tip_jacobian(q) for q in postures])


def _to_b(run: Run) -> slice:
    """Return the rows at which the tip is on its way from A to B, every fifth."""
    half = round(0.5 * float(run.config["trajectory"]["duration"]) / float(run.config["controller"]["period"]))
    return slice(0, half + 1, 5)


def _y(run: Run) -> FloatArray:
    """Return the tip's y at the same rows, in m."""
    return run.vector("tip")[_to_b(run), 1]


def jacobians(model: RobotModel, postures: FloatArray, shifted: bool, mistaken: bool) -> FloatArray:
    """Return the printed Jacobian at each posture, shape (N, 6, 7), with either of its errors or without."""
    printed = PrintedJacobian(model, shifted, mistaken)
    return np.array([printed(q) for q in postures])


def compare(runs: Runs, run: str) -> dict[str, FloatArray]:
    """Return Jacobians at random postures and at those along a run's line, shapes (N, 6, 7).

    Those `as_printed`, with only `angles` wrong, with only the columns `shifted`, `fixed`, and the `true` ones;
    `line_printed` and `line_true` along the line.
    """
    model = runs[run].model
    everywhere, line = random_postures(model, _COUNT, _SEED), runs[run].joints("q")[::5]
    forms = {"as_printed": (True, True), "angles": (False, True), "shifted": (True, False), "fixed": (False, False)}
    return {name: jacobians(model, everywhere, *wrong) for name, wrong in forms.items()} | {
        "true": _true(model, everywhere),
        "line_printed": jacobians(model, line, True, True),
        "line_true": _true(model, line),
    }


def column_rows(compared: Mapping[str, FloatArray]) -> list[list[str | float]]:
    """Return the distance of each printed column from the true one: a row for each."""
    return [_column_row(compared, k, max(k - 1, 0)) for k in range(compared["true"].shape[2])]


def _column_row(compared: Mapping[str, FloatArray], k: int, source: int) -> list[str | float]:
    off, angles, line = (
        compared[name][:, :, k] - compared[true][:, :, k]
        for name, true in (("as_printed", "true"), ("angles", "true"), ("line_printed", "line_true"))
    )
    linear = np.linalg.norm(off[:, :3], axis=1)
    return [
        str(k + 1),
        f"true column {source + 1}",
        above_rounding(float(np.abs(compared["shifted"][:, :, k] - compared["fixed"][:, :, source]).max()), digits=2),
        _largest(angles[:, :3]),
        float(np.median(linear)),
        float(linear.max()),
        _largest(line[:, :3]),
        _largest(off[:, 3:]),
    ]


def _largest(difference: FloatArray) -> float:
    """Return the largest norm of some vectors, shape (N, 3)."""
    return float(np.linalg.norm(difference, axis=1).max())


def column_errors(runs: Runs, run: str, shifted: bool) -> list[Series]:
    """Return the error of each column's linear part with mistaken angles from A to B, over the tip's y in m."""
    model, line = runs[run].model, runs[run].joints("q")[_to_b(runs[run])]
    off = np.linalg.norm((jacobians(model, line, shifted, True) - jacobians(model, line, False, False))[:, :3], axis=1)
    return [Series(f"column {k + 1}", _y(runs[run]), own) for k, own in enumerate(off.T)]


def largest_column_error(runs: Runs, run: str, shifted: bool) -> float:
    """Return the largest of these errors, in m/rad."""
    return max(float(np.max(each.y)) for each in column_errors(runs, run, shifted))


def column_values(compared: Mapping[str, FloatArray]) -> dict[str, float]:
    """Return a summary of the columns.

    Largest differences of the `fixed` columns from the true ones, and of the shifted ones from those `before` them; the
    least of the largest distances of each from its `own` true column; the `first` one's median; the least distance from
    the `last` true one; the linear part's error along the line as a `share` of its norm; smallest singular values.
    """
    true, shifted, off = compared["true"], compared["shifted"], compared["as_printed"] - compared["true"]
    printed_line, true_line = compared["line_printed"], compared["line_true"]
    errors, sizes = (np.linalg.norm(J[:, :3], axis=(1, 2)) for J in (printed_line - true_line, true_line))
    return {
        "fixed": float(np.abs(compared["fixed"] - true).max()),
        "before": float(np.abs(shifted[:, :, 1:] - true[:, :, :-1]).max()),
        "own": float(np.linalg.norm(off[:, :, 1:], axis=1).max(axis=0).min()),
        "first": float(np.median(np.linalg.norm(off[:, :, 0], axis=1))),
        "last": float(np.linalg.norm(shifted - true[:, :, 6:], axis=1).min()),
        "share": float((errors / sizes).min()),
        "smallest": float(np.linalg.svd(printed_line, compute_uv=False)[:, -1].min()),
        "true_smallest": float(np.linalg.svd(true_line, compute_uv=False)[:, -1].min()),
    }


def outcomes(runs: Runs) -> list[list[str | float | None]]:
    """Return the outcome of each run with the report's errors, and of the corrected law: a row for each."""
    rows = []
    for one in found(runs, "printed/{task}/{case}"):
        task, case = one.levels.values()
        corrected = case == "working"
        rows.append([task, "corrected law" if corrected else case, "yes" if corrected else "no", *_outcome(one.run)])
        if (fed_back := f"{one.name}/fed back") in runs:
            rows.append([task, case, "yes", *_outcome(runs[fed_back])])
    return rows


def _outcome(run: Run) -> list[str | float | None]:
    if (failure := run.failure_record) is None:
        return ["runs", *map(run.median, _METRICS), smallest_margin(run)]
    return [
        f"ends at {failure['time']:.4g} s: {str(failure['reason']).lower()}",
        *["–"] * (len(_METRICS) + 1),
    ]


def with_the_inverse(runs: Runs) -> dict[str, int]:
    """Return the numbers of runs with the inverse as printed: all, those on the line, and those that end early."""
    ours = [one.run for one in found(runs, "printed/{task}/{case=as printed|inverse alone}")]
    errors = [(run.median("max_axis_error"), line_length(run)) for run in ours]
    following = sum(error is not None and error < 0.1 * length for error, length in errors)
    return {"many": len(ours), "following": following, "ended": sum(run.failure is not None for run in ours)}
