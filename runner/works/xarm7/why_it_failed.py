"""Why the report's second part failed: the inverse that it takes does not exist."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from runner.reporting.document import Curves, FloatArray, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import above_rounding, number
from runner.store import Run
from runner.works.xarm7.plan import TASKS
from runner.works.xarm7.why_it_failed_columns import columns_section, random_postures
from runner.works.xarm7.why_it_failed_motion import motion_section

ROWS = {"position": 3, "pose": 6}


@dataclass(frozen=True)
class Inversion:
    """What comes of (J^T J)^-1 J^T over some postures.

    Attributes:
        ranks: Rank of J^T J at each posture, shape (N,).
        refused: At how many of them NumPy refuses to invert it.
        offs: |J X - 1| of what it returns elsewhere, X in place of J^+, spectral norm; zero of a pseudo-inverse.
        right: The same of J^T (J J^T)^-1 at every posture, shape (N,).
    """

    ranks: FloatArray
    refused: int
    offs: FloatArray
    right: FloatArray


def why_it_failed_section(runs: Mapping[str, Run]) -> Section:
    """Return what is wrong with the printed pseudo-inverse and Jacobian, and what each error does to the motion."""
    return Section(
        "Why the second part failed",
        (
            Text(
                "The report's second part leads the flange by all seven joints and ends with the remark that its code "
                "is not functional. What it prints is looked at in three parts: the pseudo-inverse, the order of the "
                "Jacobian's columns, and the angles behind two of its lengths."
            ),
        ),
        (_pseudo_inverse(runs), columns_section(runs), motion_section(runs)),
    )


def invert(jacobians: FloatArray) -> Inversion:
    """Take the printed pseudo-inverse of each of some Jacobians, shape (N, m, n), as NumPy does."""
    unit = np.eye(jacobians.shape[1])
    offs: list[float] = []
    refused = 0
    for J in jacobians:
        try:
            X = np.linalg.inv(J.T @ J) @ J.T
        except np.linalg.LinAlgError:
            refused += 1
        else:
            offs.append(float(np.linalg.norm(J @ X - unit, 2)))
    transposed = jacobians.transpose(0, 2, 1)
    right = transposed @ np.linalg.inv(jacobians @ transposed)
    return Inversion(
        np.linalg.matrix_rank(transposed @ jacobians).astype(float),
        refused,
        np.array(offs),
        np.linalg.norm(jacobians @ right - unit, 2, axis=(1, 2)),
    )


def _pseudo_inverse(runs: Mapping[str, Run]) -> Section:
    model = model_of(runs["printed/position/working"])
    everywhere = np.array([model.tip_jacobian(q) for q in random_postures(model)])
    table_rows, refused, cases = [], 0, 0
    surplus, offs, right = [], [], []
    for task in TASKS:
        m = ROWS[task]
        for where, jacobians in (("random", everywhere), ("line", _along(runs, task))):
            result = invert(jacobians[:, :m])
            refused += result.refused
            cases += len(jacobians)
            surplus.append(float(result.ranks.max()) - m)
            offs.append(result.offs)
            right.append(float(result.right.max()))
            low, high = (f"{value:.0f}" for value in (result.ranks.min(), result.ranks.max()))
            found = result.offs.size
            table_rows.append(
                [
                    f"{m} × {model.nq}",
                    f"{len(jacobians)}, {where}",
                    f"{low} of {model.nq}" if low == high else f"{low} to {high} of {model.nq}",
                    str(result.refused),
                    f"{number(float(np.median(result.offs)), 2)} (up to {number(float(result.offs.max()), 2)})"
                    if found
                    else "–",
                    above_rounding(float(result.right.max()), digits=2),
                ]
            )
    answers = np.concatenate(offs)
    return Section(
        "The inverse does not exist",
        (
            Formula(
                "J^+ = (J^T J)^(-1) J^T",
                "J plus equals the inverse of J transposed J, times J transposed",
                "as printed",
            ),
            Text(
                "This is the pseudo-inverse of a tall matrix with independent columns. The Jacobian of an arm with "
                "joints to spare is wide. $J^T J$ is then of order 7 and, having no more independent columns than $J$ "
                "has rows, of rank 3 or 6: it has no inverse to take. Of a wide matrix it is $J J^T$ that has one:"
            ),
            Formula(
                "J^+ = J^T (J J^T)^(-1)",
                "J plus equals J transposed times the inverse of J J transposed",
            ),
            Table(
                "The printed pseudo-inverse X of the right Jacobian, and the right one: |J X - 1|, which is zero where "
                "X leads the tip as told; median and largest value.",
                [
                    "Jacobian",
                    "postures",
                    "rank of $J^T J$",
                    "no answer",
                    "printed: |J X - 1| of the answers",
                    "right: |J X - 1|",
                ],
                table_rows,
                (3, 4, 5),
                origin(runs["printed/position/working"]),
            ),
            _singular_values(runs),
            conclude(
                cases,
                Measured("cases in which NumPy says singular", float(refused)),
                Measured("rank of the matrix beyond the rows of the Jacobian", max(surplus)),
                Measured("median |J X - 1| of the printed answers", _of(np.median, answers)),
                Measured("smallest |J X - 1| of the printed answers", _of(np.min, answers)),
                Measured("largest |J X - 1| of the right pseudo-inverse", max(right)),
            ),
        ),
    )


def conclude(
    cases: int, refused: Measured, surplus: Measured, median: Measured, best: Measured, right: Measured
) -> Finding:
    """Return what the printed pseudo-inverse is worth.

    Args:
        cases: How many Jacobians were tried.
        refused: At how many of them NumPy refuses to invert the matrix.
        surplus: By how much the matrix's rank is at most larger than the number of the Jacobian's rows.
        median: Median of |J X - 1| of the other answers.
        best: The smallest of it.
        right: The largest of it with the right pseudo-inverse.
    """
    return finding(
        "The printed pseudo-inverse is division by rounding errors",
        f"The matrix has no more rank than the Jacobian has rows, so that it has no inverse. In {refused} of these "
        f"{cases} cases NumPy says so. In the others the zeros among its singular values are rounding errors, and the "
        f"answer is made of their inverses: the tip's velocity misses what was asked by {median} of it in the median, "
        f"and by {best} at best, where no motion at all misses it by the whole. The right pseudo-inverse misses it by "
        f"{right} at worst.",
        surplus <= 0.0,
        median > 0.5,
        best > 1e-3,
        right < 1e-6,
    )


def _of(what: Callable[[FloatArray], np.float64], values: FloatArray) -> float | None:
    return float(what(values)) if values.size else None


def _along(runs: Mapping[str, Run], task: str) -> FloatArray:
    """Return the right Jacobians along the line, from A to B, shape (N, 6, 7)."""
    run = runs[f"printed/{task}/working"]
    model, q = model_of(run), joint_columns(run.trace, "q")
    return np.array([model.tip_jacobian(row) for row in q[: _half(run) + 1 : 5]])


def _half(run: Run) -> int:
    """Return the row at which the tip is to be at B."""
    return round(0.5 * float(run.config["trajectory"]["duration"]) / float(run.config["controller"]["period"]))


def _singular_values(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for task in TASKS:
        run = runs[f"printed/{task}/working"]
        y = columns(run.trace, "tip")[: _half(run) + 1 : 5, 1]
        J = _along(runs, task)[:, : ROWS[task]]
        values = np.linalg.svd(J.transpose(0, 2, 1) @ J, compute_uv=False)
        series = [
            Series(
                f"singular value {k + 1}" if k < ROWS[task] else ("zero, rounded" if k == ROWS[task] else ""),
                y,
                np.where(values[:, k] > 0.0, values[:, k], np.nan),
                "line" if k < ROWS[task] else "dotted",
                color=min(k, ROWS[task]),
            )
            for k in range(values.shape[1])
        ]
        title = f"{ROWS[task]} rows ({task})"
        panels.append(Panel(title, "y of the tip (m)", "singular value (m², or mixed)", series, y_log=True))
    return Curves(
        "The seven singular values of $J^T J$ along the line, right Jacobian; those beyond the number of its rows are "
        "dotted.",
        panels,
        2,
        origin(runs["printed/position/working"]),
    )
