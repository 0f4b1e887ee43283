"""Derivatives of metrics that are smooth functionals of the signals of a run; see the families in runner/metrics.

The derivative of a maximum is the derivative of the sample at which it is reached. It is exact if there is only one
such sample.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from runner.assembly.compiled.loops import Rows
from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, unknown
from runner.base.trace import Trace
from runner.metrics.family import MetricContext
from runner.metrics.positioning import STEADY_WINDOW

WITHOUT = {
    "settling_time": "it jumps from one tick to another, and stays in between",
    "saturation_fraction": "it counts ticks",
    "reach_loss_fraction": "it counts ticks",
    "cross_track_error": "it is the distance to the nearest point of a curve, whose change is not computed",
}
"""Metrics without a derivative, with the reason."""


def derivatives(trace: Trace, change: Rows, context: MetricContext) -> dict[str, FloatArray]:
    """Return the derivatives of the smooth metrics of a run by each parameter, shapes (parameters,), by metric.

    Args:
        trace: Trace of the run.
        change: Derivatives of the signals of the trace; the axis of the parameters is that of several runs.
        context: Context of the metrics of the run.
    """
    found = _of_tip(trace, change.end_points[-1], context) | _of_joints(trace, change, context.period)
    for index, stage in enumerate(trace.stage_names[:-1]):
        stage_context = context.at_stage(trace.offsets[index])
        of_stage = _of_tip(trace.at_stage(index), change.end_points[index], stage_context)
        found |= {f"{stage}_{name}": values for name, values in of_stage.items()}
    return found


def check_smooth(name: str, known: Mapping[str, object]) -> None:
    """Check that a metric has a derivative.

    Raises:
        RunnerError: if it has none; the message contains the reason and the metrics with a derivative.
    """
    if name in known:
        return
    why = next((reason for base, reason in WITHOUT.items() if f"_{base}_" in f"_{name}_"), None)
    if why is None:
        raise RunnerError(unknown("metric with a derivative", name, known, "--metrics"))
    raise RunnerError(f"--metrics: {name} has no derivative: {why}. Allowed: {', '.join(known)}.")


def _of_tip(trace: Trace, tip: FloatArray, context: MetricContext) -> dict[str, FloatArray]:
    """Return the derivatives of the metrics of an end point, whose derivatives are `tip`, shape (parameters, T, 3)."""
    trajectory, error, found = context.trajectory, trace.error, dict[str, FloatArray]()

    def largest(rows: slice, axes: slice) -> FloatArray:
        size = np.abs(error[rows, axes])
        row, axis = np.unravel_index(int(np.argmax(size)), size.shape)
        changed: FloatArray = -np.sign(error[rows, axes][row, axis]) * tip[:, rows, axes][:, row, axis]
        return changed

    if trajectory.tracked:
        ticks = int(np.searchsorted(trace.t, trajectory.duration + 1e-9, side="right"))
        on_way = slice(0, ticks)
        norm = np.linalg.norm(error[on_way], axis=1)
        row = int(np.argmax(norm))
        found["max_tracking_error"] = _ratio(-tip[:, row] @ error[row], norm[row])
        for axis, letter in enumerate("xyz"):
            found[f"max_tracking_error_{letter}"] = largest(on_way, slice(axis, axis + 1))
        found["max_axis_error"] = largest(on_way, slice(0, 3))
        rms = np.sqrt((error[on_way] ** 2).sum() / ticks)
        found["rms_tracking_error"] = _ratio(-np.einsum("ta,pta->p", error[on_way], tip[:, on_way]), ticks * rms)
    goal, end = trajectory.goal, trace.t[-1] - STEADY_WINDOW
    if goal is None:
        return found
    if end >= trajectory.duration - 1e-9:
        found["steady_state_error"] = largest(slice(int(np.searchsorted(trace.t, end - 1e-9)), None), slice(0, 3))
    distance = float(np.linalg.norm(goal - trajectory.start))
    if distance > 0.0:
        along = (goal - trajectory.start) / distance
        past, wanted = (trace.tip - goal) @ along, (trace.desired[:, 0] - goal) @ along
        row, beyond = int(np.argmax(past)), past.max() > max(wanted.max(), 0.0)
        found["overshoot"] = tip[:, row] @ along if beyond else np.zeros(len(tip))
    return found


def _of_joints(trace: Trace, change: Rows, period: float) -> dict[str, FloatArray]:
    held, d_held = trace.tau[:-1], change.command[:, :-1]
    moved, d_moved = np.diff(trace.q, axis=0), np.diff(change.q, axis=1)
    side = np.sign(held * moved)
    found = {"energy": np.einsum("tj,ptj->p", side, d_held * moved + held * d_moved)}
    squares = 2.0 * np.einsum("tj,ptj->pj", held, d_held)
    prismatic = np.array([unit == "m" for unit in trace.joint_units])
    steps, d_steps = np.diff(held, axis=0), np.diff(d_held, axis=1)
    for peak, rms, chatter, fastest, effort, chosen in (
        ("peak_torque", "rms_torque", "torque_chatter", "peak_joint_speed", "control_effort", ~prismatic),
        ("peak_joint_force", "rms_joint_force", "force_chatter", "peak_sliding_speed", "force_effort", prismatic),
    ):
        joints = np.flatnonzero(chosen)
        if not len(joints):
            continue
        found[effort] = squares[:, joints].sum(axis=1) * period
        found |= _over_joints(peak, _largest, held, d_held, joints)
        found |= _over_joints(fastest, _largest, trace.dq, change.dq, joints)
        found |= _over_joints(rms, _root_mean_square, held, d_held, joints)
        found |= _over_joints(chatter, _root_mean_square, steps, d_steps, joints)
    return found


def _over_joints(
    name: str, derivative: Callable[..., FloatArray], signal: FloatArray, changed: FloatArray, joints: NDArray[np.intp]
) -> dict[str, FloatArray]:
    alone = {f"{name}_q{j + 1}": derivative(signal[:, [j]], changed[:, :, [j]]) for j in joints}
    return {name: derivative(signal[:, joints], changed[:, :, joints]), **alone}


def _largest(signal: FloatArray, changed: FloatArray) -> FloatArray:
    row, joint = np.unravel_index(int(np.argmax(np.abs(signal))), signal.shape)
    found: FloatArray = np.sign(signal[row, joint]) * changed[:, row, joint]
    return found


def _root_mean_square(signal: FloatArray, changed: FloatArray) -> FloatArray:
    size = np.sqrt((signal**2).mean()) if signal.size else 0.0
    return _ratio(np.einsum("tj,ptj->p", signal, changed), signal.size * size)


def _ratio(numerator: FloatArray, denominator: float) -> FloatArray:
    return numerator / denominator if denominator > 0.0 else np.zeros_like(numerator)
