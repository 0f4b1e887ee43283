"""Motion for a run, made from the positions of a log: thinned, from rest to rest, within the limits of the arm."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.limits import TABLE_NUMBERS
from runner.base.quantities import quantity
from runner.base.sanitize import csv_text
from runner.recordings.columns_map import Signal
from runner.recordings.recording import Recording
from runner.recordings.smoothing import cutoff, evenly, low_pass
from runner.robots.model import RobotModel
from runner.trajectories.splines import interpolate

_STEP = 0.01  # s between rows, at least
_REST = 0.02  # of the largest speed: what is slower at an end is at rest
_OVER, _OF_NOISE = 0.15, 6.0  # s in which it moves by more than 6 times the rms of the noise
_EQUAL = 1e-9  # rad or m: what no encoder resolves
_LEAD = 0.5  # s, in which a log that begins or ends in motion comes from rest or goes to it
_MARGIN = 1e-3  # of a joint's range, kept from its limits
_MOST = 40_000  # rows that are looked at
_LOWER = 0.7  # factor of the cut-off, if speeds exceed the limits
_LOWEST = 1.0  # Hz


@dataclass(frozen=True)
class LogMotion:
    """A motion from a log.

    Attributes:
        text: CSV with the columns t, q1, q2 and so on.
        rows: Number of its rows.
        commanded: Whether it is made of commanded positions.
        notes: What was done, and the error that it makes.
    """

    text: str
    rows: int
    commanded: bool
    notes: tuple[str, ...]


def make_motion(model: RobotModel, recording: Recording) -> LogMotion | None:
    """Return the motion of a log: its commanded positions, or the measured ones; None if a joint has neither."""
    commands = [recording.signals.get(Signal("reference", joint)) for joint in model.joint_names]
    measured = recording.positions(model.joint_names)
    commanded = all(command is not None for command in commands)
    if not commanded and measured is None:
        return None
    q = np.column_stack([command for command in commands if command is not None]) if commanded else measured
    assert q is not None  # noqa: S101 - one of both is there
    every = max(1, len(recording.t) // _MOST)
    period = every * recording.period
    times = np.minimum(period * np.arange(int(recording.duration / period + 1e-6) + 1), recording.t[::every][-1])
    exact = evenly(recording.t[::every], q[::every], times)
    step = max(
        _STEP, period, (recording.duration + 2.0 * _LEAD) * (model.nq + 1) / (TABLE_NUMBERS.most - 10 * model.nq)
    )
    notes: list[str] = []
    frequency = min(cutoff(period), 0.4 / step)
    while True:
        smooth = low_pass(exact, period, frequency)
        noise = _noise(exact - smooth, period * frequency)
        t, rows = _rest_to_rest(times, smooth, noise, step)
        rows, clipped = _inside(model, rows)
        curve = interpolate(t, rows[:, None], "spline")
        speeds = curve.orders[1](np.linspace(0.0, t[-1], 4 * len(t)))
        fast = float((np.abs(speeds).max(axis=0) / model.velocity_limits).max())
        if fast < 1.0 or frequency * _LOWER < _LOWEST:
            break
        frequency *= _LOWER
    moving = _in_motion(times, smooth, noise)
    off = np.abs(curve.orders[0](times - times[0] + _LEAD * moving[0]) - exact).max(axis=0)
    worst = int(np.argmax(off / np.maximum(np.ptp(exact, axis=0), 1e-9)))
    unit = model.joint_units[worst]
    apart = f"differ from the log by up to {quantity(float(off[worst]), unit)} at {model.joint_names[worst]}"
    notes.append(
        f"{len(t)} rows, {quantity(step, 's')} apart, smoothed at {frequency:.2g} Hz; they "
        f"{apart if off.max() > _EQUAL else 'are equal to the log'}"
    )
    if any(moving):
        notes.append(f"the log begins or ends in motion: {_LEAD:g} s from or to rest are added")
    if clipped > 0.0:
        notes.append(f"positions beyond the limits of the arm are cut, by up to {quantity(clipped, unit)}")
    if fast >= 1.0:
        notes.append(f"speeds reach {fast:.2f} times the limit of the arm: the run will refuse it")
    cells = [["t", *(f"q{joint + 1}" for joint in range(model.nq))]]
    cells += [[f"{time:.9g}", *(f"{value:.9g}" for value in row)] for time, row in zip(t, rows, strict=True)]
    return LogMotion(csv_text(cells), len(t), commanded, tuple(notes))


def _noise(removed: FloatArray, share: float) -> FloatArray:
    """Return the rms of white noise that a low-pass leaves, shape (nq,).

    Args:
        removed: What it removed, shape (N, nq).
        share: Its cut-off as a share of the rate.
    """
    noise: FloatArray = np.sqrt(np.mean(removed**2, axis=0) * 2.0 * share)
    return noise


def _in_motion(times: FloatArray, q: FloatArray, noise: FloatArray) -> tuple[bool, bool]:
    """Return whether a motion begins and ends in motion: whether means over _OVER differ by more than noise."""
    rows = min(len(times) // 2, max(1, round(_OVER / (times[1] - times[0]))))
    means = np.diff(np.cumsum(np.vstack([0.0 * q[:1], q]), axis=0)[::rows], axis=0) / rows
    steps = np.abs(np.diff(means, axis=0))
    last = np.abs(q[-rows:].mean(axis=0) - q[-2 * rows : -rows].mean(axis=0))
    least = np.maximum(_REST * max(float(steps.max()), 1e-12), _OF_NOISE * noise)
    return bool((steps[0] > least).any()), bool((last > least).any())


def _rest_to_rest(times: FloatArray, q: FloatArray, noise: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """Return even rows of a motion, with a way from rest before a log that begins in motion, and one to rest after it.

    On that way the speed grows or falls as a smooth step, so that positions change by half of speed times duration.
    """
    first, last = _in_motion(times, q, noise)
    count = max(3, int(np.ceil((times[-1] - times[0]) / step)) + 1)
    even = np.linspace(times[0], times[-1], count)
    rows = [evenly(times, q, even)]
    slopes = np.gradient(q, times, axis=0)[[0, -1]]
    steps = max(2, round(_LEAD / step))
    share = np.linspace(0.0, 1.0, steps + 1)[1:, None]  # of the way, from the log on
    gone = _LEAD * (share - share**3 + 0.5 * share**4)  # integral of 1 - 3 s^2 + 2 s^3
    t = even
    if first:
        rows.insert(0, (q[0] - slopes[0] * gone)[::-1])
        t = np.concatenate([even[0] - _LEAD * share[::-1, 0], t])
    if last:
        rows.append(q[-1] + slopes[1] * gone)
        t = np.concatenate([t, even[-1] + _LEAD * share[:, 0]])
    return t - t[0], np.vstack(rows)


def _inside(model: RobotModel, rows: FloatArray) -> tuple[FloatArray, float]:
    """Return positions within the limits, and by how much one was beyond them."""
    lower, upper = model.position_limits
    margin = np.where(np.isfinite(upper - lower), _MARGIN * (upper - lower), 0.0)
    beyond = max(float((rows - upper).max()), float((lower - rows).max()), 0.0)
    return np.clip(rows, lower + margin, upper - margin) if beyond > 0.0 else rows, beyond
