"""What the studies of the combined arm share: reading runs of which some may have failed, and measures of its shape."""

from collections.abc import Iterable, Mapping

import numpy as np
import pinocchio as pin

from runner.reporting.document import Block, FloatArray, Notice
from runner.reporting.figures import columns, joint_columns, model_of
from runner.reporting.quantities import number
from runner.store import Run


def median(run: Run, metric: str) -> float | None:
    """Return the median of a metric; None where the run failed or the metric has no value."""
    stored = run.metrics.get(metric)
    return None if stored is None or stored["median"] is None else float(stored["median"])


def cell(run: Run, metric: str, digits: int = 3) -> str:
    """Return the median of a metric for a table: "failed" for a failed run, a dash for a value that is missing."""
    return "failed" if run.status == "failed" else number(median(run, metric), digits)


def settled(run: Run) -> str:
    """Return the settling time for a table; "never" where the tip has not settled."""
    if run.status == "failed":
        return "failed"
    return "never" if median(run, "settling_time") is None else cell(run, "settling_time")


def ratio(large: float | None, small: float | None) -> str:
    """Return how many times one number is another; a dash where one is missing or zero."""
    return number(large / small, 2) if large is not None and small else "–"


def values(runs: Iterable[Run], metric: str) -> FloatArray:
    """Return the medians of a metric, NaN where there is none."""
    return np.array([np.nan if (m := median(run, metric)) is None else m for run in runs])


def failures(runs: Mapping[str, Run]) -> list[Block]:
    """Return a notice that names each failed run with its failure; nothing where none failed."""
    reasons: dict[str, list[str]] = {}
    for name, run in runs.items():
        if run.failure is not None:
            joint = f", {run.failure['joint']}" if run.failure["joint"] else ""
            where = f"{name.partition('/')[2]} (at {run.failure['time']:.4g} s{joint})"
            reasons.setdefault(str(run.failure["reason"]), []).append(where)
    if not reasons:
        return []
    count = sum(map(len, reasons.values()))
    text = ". ".join(f"{reason}: {'; '.join(names)}" for reason, names in reasons.items())
    return [Notice("failure", f"{count} of {len(runs)} runs failed", f"{text[0].upper()}{text[1:]}.")]


def clock(run: Run) -> FloatArray:
    """Return the times of a trace's rows, in s."""
    times: FloatArray = run.trace["t"].to_numpy()
    return times


def largest(values: FloatArray) -> float | None:
    """Return the largest finite value, or None."""
    finite = values[np.isfinite(values)]
    return float(finite.max()) if finite.size else None


def apart(first: Run, second: Run, signal: str) -> FloatArray:
    """Return the distance between a tip signal of two runs at their common ticks, shape (T,), in m."""
    rows = min(len(first.trace), len(second.trace))
    difference = columns(first.trace[:rows], signal) - columns(second.trace[:rows], signal)
    distance: FloatArray = np.linalg.norm(difference, axis=1)
    return distance


def rest_of_way(run: Run) -> FloatArray:
    """Return |x_d - x_E|, from the Macro's end point to the target, shape (T,), in m."""
    distance: FloatArray = np.linalg.norm(columns(run.trace, "desired") - columns(run.trace, "macro_tip"), axis=1)
    return distance


def extension(run: Run) -> FloatArray:
    """Return |p|, from the Macro's end point to the tip, shape (T,), in m."""
    distance: FloatArray = np.linalg.norm(columns(run.trace, "tip") - columns(run.trace, "macro_tip"), axis=1)
    return distance


def mini_dexterity(run: Run) -> FloatArray:
    """Return smallest singular value (m) and manipulability |det J| (m^3) of the Mini at each tick, shape (T, 2).

    They do not depend on the frame, so the Mini's columns of the whole arm's Jacobian serve.
    """
    model = model_of(run)
    measures = np.full((len(run.trace), 2), np.nan)
    for row, q in zip(measures, joint_columns(run.trace, "q"), strict=True):
        if np.isfinite(q).all():
            singular = np.linalg.svd(model.tip_jacobian(q)[:3, 3:], compute_uv=False)
            row[:] = singular[-1], singular.prod()
    return measures


def wrist_rotations(run: Run) -> FloatArray:
    """Return the true rotation from the Mini's base frame into the robot's at each tick, shape (T, 3, 3)."""
    model = model_of(run)
    base = model.pin_model.getFrameId(run.provenance["stages"]["mini"])
    data = model.pin_model.createData()
    rotations = np.full((len(run.trace), 3, 3), np.nan)
    for row, q in zip(rotations, joint_columns(run.trace, "q"), strict=True):
        if np.isfinite(q).all():
            pin.forwardKinematics(model.pin_model, data, q)
            row[:] = pin.updateFramePlacement(model.pin_model, data, base).rotation
    return rotations
