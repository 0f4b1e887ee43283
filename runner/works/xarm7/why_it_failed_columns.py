"""Which columns of the xArm7 report's Jacobian are wrong, and by how much."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.xarm7_as_printed import PrintedJacobian
from runner.reporting.document import Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import above_rounding, number
from runner.robots import RobotModel
from runner.store import Run

COUNT = 1000
_SEED = 7


def random_postures(model: RobotModel) -> FloatArray:
    """Return postures drawn evenly from within the joint limits, shape (1000, nq), in rad."""
    lower, upper = model.position_limits
    return np.random.default_rng(_SEED).uniform(lower, upper, (COUNT, model.nq))


def jacobians(model: RobotModel, postures: FloatArray, shifted: bool, mistaken: bool) -> FloatArray:
    """Return the printed Jacobian at each posture, shape (N, 6, 7), with either of its errors or without."""
    printed = PrintedJacobian(model, shifted, mistaken)
    return np.array([printed(q) for q in postures])


def columns_section(runs: Mapping[str, Run]) -> Section:
    """Return how far each printed column is from the true one, over random postures and along the line."""
    run = runs["printed/position/working"]
    model = model_of(run)
    everywhere, line = random_postures(model), joint_columns(run.trace, "q")[::5]
    return Section(
        "The columns are wrong",
        (
            Text(
                "The report writes out every entry of a 6 × 7 Jacobian. Its column $k$ should be "
                "$z_k times (p_E - p_k)$ over $z_k$, with axis and origin of joint $k$. The printed entries take "
                "those of the frame before, as other conventions do; but in the report's transforms the constant part "
                "comes first, and the axis of that frame is the axis of the joint before. So column $k$ is the true "
                "column $k - 1$, $J_(12) = J_(11)$, and the last true column appears nowhere. Moreover "
                "$l_4$ and $l_5$ are followed by the cosines and sines of $q_1$, of $q_5$ and of $q_2$ where the "
                "constants $theta_1$ and $theta_2$ are meant; the transforms printed before have them right."
            ),
            _table(run, model, everywhere, line),
            _curves(run, model),
            _concluded(model, everywhere, line),
        ),
    )


def _table(run: Run, model: RobotModel, everywhere: FloatArray, line: FloatArray) -> Table:
    true, unshifted = (jacobians(model, everywhere, False, mistaken) for mistaken in (False, True))
    shifted, both = (jacobians(model, everywhere, True, mistaken) for mistaken in (False, True))
    true_line, both_line = jacobians(model, line, False, False), jacobians(model, line, True, True)
    rows = []
    for k in range(model.nq):
        source = max(k - 1, 0)
        linear = np.linalg.norm(both[:, :3, k] - true[:, :3, k], axis=1)
        rows.append(
            [
                str(k + 1),
                f"true column {source + 1}",
                above_rounding(float(np.abs(shifted[:, :, k] - true[:, :, source]).max()), digits=2),
                _largest(unshifted[:, :3, k] - true[:, :3, k]),
                number(float(np.median(linear))),
                number(float(linear.max())),
                _largest(both_line[:, :3, k] - true_line[:, :3, k]),
                _largest(both[:, 3:, k] - true[:, 3:, k]),
            ]
        )
    return Table(
        f"The printed Jacobian against the true one, over {len(everywhere)} random postures within the joint limits "
        f"and {len(line)} along the line: norms of the difference of columns.",
        [
            "column",
            "is, but for the angles",
            "differs from it by",
            "angles alone: linear part (m)",
            "as printed, random: median (m)",
            "largest (m)",
            "as printed, line: largest (m)",
            "angular part: largest (1)",
        ],
        rows,
        (2, 3, 4, 5, 6, 7),
        origin(run),
    )


def _largest(difference: FloatArray) -> str:
    """Return the largest norm of some vectors, shape (N, 3)."""
    return above_rounding(float(np.linalg.norm(difference, axis=1).max()))


def _curves(run: Run, model: RobotModel) -> Curves:
    half = len(run.trace) // 2 + 1
    y = columns(run.trace, "tip")[:half:5, 1]
    line = joint_columns(run.trace, "q")[:half:5]
    true = jacobians(model, line, False, False)
    panels = []
    for title, shifted, mistaken in (("As printed", True, True), ("Angles alone", False, True)):
        off = np.linalg.norm((jacobians(model, line, shifted, mistaken) - true)[:, :3], axis=1)
        series = [Series(f"column {k + 1}", y, off[:, k]) for k in range(model.nq)]
        panels.append(Panel(title, "y of the tip (m)", "error of the linear part (m)", series))
    return Curves("Error of each column along the line, from A to B.", panels, 2, origin(run))


def _concluded(model: RobotModel, everywhere: FloatArray, line: FloatArray) -> Finding:
    true, right = (np.array([model.tip_jacobian(q) for q in everywhere]), jacobians(model, everywhere, False, False))
    shifted, both = (jacobians(model, everywhere, True, mistaken) for mistaken in (False, True))
    printed = jacobians(model, line, True, True)
    true_line = jacobians(model, line, False, False)
    off, size = (np.linalg.norm(J[:, :3], axis=(1, 2)) for J in (printed - true_line, true_line))
    smallest = [float(np.linalg.svd(J, compute_uv=False)[:, -1].min()) for J in (printed, true_line)]
    before = np.abs(shifted[:, :, 1:] - true[:, :, :-1]).max()
    own = np.linalg.norm(both[:, :, 1:] - true[:, :, 1:], axis=1).max(axis=0).min()
    first = np.median(np.linalg.norm(both[:, :, 0] - true[:, :, 0], axis=1))
    last = np.linalg.norm(shifted - true[:, :, 6:], axis=1).min()
    return conclude(
        Measured("distance of the entries with both errors put right", float(np.abs(right - true).max())),
        Measured("distance of columns two to seven from the true column before, angles put right", float(before)),
        Measured("least of the largest distances of these from their own true columns", float(own)),
        Measured("median distance of column one from the true one, angles as printed", float(first)),
        Measured("least distance of any column from the last true one", float(last)),
        Measured("least error of the linear part along the line over its norm", float((off / size).min())),
        Measured("smallest singular value as printed", smallest[0]),
        Measured("smallest singular value of the true Jacobian", smallest[1]),
    )


def conclude(
    mended: Measured,
    before: Measured,
    own: Measured,
    first: Measured,
    last: Measured,
    share: Measured,
    smallest: Measured,
    true_smallest: Measured,
) -> Finding:
    """Return what is wrong with the printed columns.

    Args:
        mended: Largest difference between the entries with both errors put right and the true ones.
        before: The same between the columns but the first, angles put right, and the true columns before them.
        own: Least over these columns of the largest distance from their own true columns.
        first: Median distance of the first column as printed from the true one.
        last: Least distance of any column from the last true one.
        share: Least error of the linear part along the line, over its norm.
        smallest: Smallest singular value of the six rows along the line, as printed.
        true_smallest: The same of the true ones.
    """
    return finding(
        "Every column but the first is another joint's, and the first has the wrong angles",
        "With both errors put right the printed entries are the true Jacobian at every random posture (largest "
        f"difference {mended}), so there is no third error. With the angles put right every column but the first is "
        "that of the joint before; the last joint's appears nowhere. Along the line the linear part as printed is off "
        f"by more than its own norm: by {share} times that at least. It keeps its rank (smallest singular value of "
        f"the six rows along the line {smallest}, of the true ones {true_smallest}): nothing in the numbers warns of "
        "it.",
        mended < 1e-9,
        before < 1e-9,
        own > 0.1,
        first > 0.05,
        last > 1e-3,
        share > 1.1,
        smallest > 0.5 * true_smallest,
    )
