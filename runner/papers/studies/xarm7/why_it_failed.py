"""Errors in the report's second part: inverse, Jacobian, and their effect on the motion."""

from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.studies.xarm7.figures import ROWS, line_length
from runner.papers.studies.xarm7.kinematics import random_postures
from runner.papers.studies.xarm7.parts.xarm7_as_printed import PrintedJacobian
from runner.papers.study.results import Runs
from runner.reporting.document import Series
from runner.robots.model import RobotModel
from runner.store import Run

_COUNT, _SEED = 1000, 7  # of the random postures
_ZERO = 7  # palette index of singular values that are zero except for rounding


def invert(jacobians: FloatArray) -> dict[str, FloatArray]:
    """Take the printed pseudo-inverse X = (J^T J)^-1 J^T of some Jacobians, shape (N, m, n), by NumPy.

    Returns:
        Rank of J^T J at each posture, `ranks`; |J X - 1|, spectral norm, if NumPy does not refuse to invert, `offs`;
        the same of J^T (J J^T)^-1 at every posture, `right`.
    """
    unit = np.eye(jacobians.shape[1])
    offs: list[float] = []
    for J in jacobians:
        with suppress(np.linalg.LinAlgError):
            offs.append(float(np.linalg.norm(J @ (np.linalg.inv(J.T @ J) @ J.T) - unit, 2)))
    transposed = jacobians.transpose(0, 2, 1)
    right = transposed @ np.linalg.inv(jacobians @ transposed)
    return {
        "ranks": np.linalg.matrix_rank(transposed @ jacobians).astype(float),
        "offs": np.array(offs),
        "right": np.linalg.norm(jacobians @ right - unit, 2, axis=(1, 2)),
    }


def inversions(runs: Runs) -> dict[str, dict[str, FloatArray]]:
    """Return the inversions by the tip's task and the kind of postures, such as "pose, random" or "pose, line"."""
    model = runs["printed/position/working"].model
    everywhere = _true(model, random_postures(model, _COUNT, _SEED))
    return {
        f"{task}, {where}": invert(jacobians[:, :rows])
        for task, rows in ROWS.items()
        for where, jacobians in (("random", everywhere), ("line", _along(runs, task)))
    }


def inverse_rows(tried: Mapping[str, Mapping[str, FloatArray]]) -> list[list[str | float | None]]:
    """Return case, postures, largest rank, refused ones, median and largest |J X - 1|, and that of the right."""
    rows: list[list[str | float | None]] = []
    for case, own in tried.items():
        offs, right = own["offs"], own["right"]
        found = [of(offs) if offs.size else None for of in (np.median, np.max)]
        rows.append([case, right.size, own["ranks"].max(), right.size - offs.size, *found, right.max()])
    return rows


def inverse_values(tried: Mapping[str, Mapping[str, FloatArray]]) -> dict[str, float | None]:
    """Return their summary: cases, those refused, rank beyond J's rows, |J X - 1| of printed and right."""
    ranks, answers, right = ([own[name] for own in tried.values()] for name in ("ranks", "offs", "right"))
    offs, rows = np.concatenate(answers), [ROWS[case.partition(",")[0]] for case in tried]
    cases = sum(own.size for own in right)
    return {
        "cases": cases,
        "refused": cases - offs.size,
        "surplus": max(float(own.max()) - least for own, least in zip(ranks, rows, strict=True)),
        "median": float(np.median(offs)) if offs.size else None,
        "best": float(offs.min()) if offs.size else None,
        "right": float(np.concatenate(right).max()),
    }


def singular_values(runs: Runs, task: str) -> list[Series]:
    """Return the singular values of J^T J of the right Jacobian along the line, over the tip's y in m."""
    rows, y = ROWS[task], _y(runs[f"printed/{task}/working"])
    names = [*(f"singular value {k + 1}" for k in range(rows)), "zero, rounded", *[""] * (6 - rows)]
    return [
        Series(name, y, own, "line" if k < rows else "dotted", color=k if k < rows else _ZERO)
        for k, (name, own) in enumerate(zip(names, _squares(runs, task).T, strict=True))
    ]


def least_singular_value(runs: Runs) -> float:
    """Return the least singular value along the line that the rows of J account for."""
    return min(float(_squares(runs, task)[:, :rows].min()) for task, rows in ROWS.items())


def _squares(runs: Runs, task: str) -> FloatArray:
    """Return the singular values of J^T J along the line, shape (N, 7)."""
    J = _along(runs, task)[:, : ROWS[task]]
    return np.asarray(np.linalg.svd(J.transpose(0, 2, 1) @ J, compute_uv=False))


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


def outcome(run: Run) -> str:
    """Return the outcome of a run as a cell of a table."""
    failure = run.failure_record
    return "runs" if failure is None else f"ends at {failure['time']:.4g} s: {str(failure['reason']).lower()}"


def follows(run: Run) -> bool:
    """Return True if the tip stays within a tenth of the line's length."""
    error = run.median("max_axis_error")
    return error is not None and error < 0.1 * line_length(run)
