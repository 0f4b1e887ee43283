"""Motions of a recording, cut at rests: accuracy of the model in each, and by speed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.recordings.columns_map import Signal
from runner.recordings.compare import RecordingComparison, Residual

_REST = 0.02  # of the largest speed of a joint: a joint that is slower rests
_PAUSE = 0.2  # s, the shortest rest
_SHORTEST = 0.1  # s, of a motion
_FEWEST = 6  # motions that are grouped by speed
_MOST_ROWS = 4_000  # rows for the distance of the tip
GROUPS = ("slow", "medium", "fast")


@dataclass(frozen=True)
class Accuracy:
    """Accuracy of the model over some of the compared ticks.

    Attributes:
        name: Number of the motion, or the group of motions by speed.
        motions: Number of motions.
        first: Start on the run's clock, in s; NaN for a group.
        last: End on the run's clock, in s; NaN for a group.
        speeds: Smallest and largest of the motions' peak speeds, each as a share of the joint's largest speed.
        position: What the difference of the positions stays below for 95 % of the time, at the worst joint.
        joint: This joint; empty without positions.
        unit: Unit of the position.
        tip: The same of the tip's distance, in m; NaN if a joint has no recorded position.
        torque: Rms of the torques' differences over that of the recorded torques; NaN without torques.
    """

    name: str
    motions: int
    first: float
    last: float
    speeds: tuple[float, float]
    position: float
    joint: str
    unit: str
    tip: float
    torque: float


def cut_at_rests(found: RecordingComparison) -> list[slice]:
    """Return the compared ticks of each motion: of the time between two rests of all joints."""
    moving = _of_kind(found, "position") or _of_kind(found, "tip")
    t = moving[0].t
    speeds = _speeds(moving)
    busy = (speeds > _REST).any(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], busy, [False]]).astype(int)))
    parts = [[int(first), int(end)] for first, end in zip(edges[::2], edges[1::2], strict=True)]
    joined: list[list[int]] = []
    for part in parts:
        if joined and t[part[0]] - t[joined[-1][1] - 1] < _PAUSE:
            joined[-1][1] = part[1]
        else:
            joined.append(part)
    return [slice(*part) for part in joined if t[part[1] - 1] - t[part[0]] >= _SHORTEST]


def accuracies(found: RecordingComparison) -> tuple[list[Accuracy], list[Accuracy]]:
    """Return the accuracy in each motion, and by group of speed: slow, medium and fast thirds; none for few motions."""
    parts = cut_at_rests(found)
    moving = _of_kind(found, "position") or _of_kind(found, "tip")
    t, speeds = moving[0].t, _speeds(moving)
    peaks = np.array([float(speeds[part].max()) for part in parts])
    each = [
        _accuracy(found, str(number), [part], peaks[[number - 1]], (float(t[part.start]), float(t[part.stop - 1])))
        for number, part in enumerate(parts, start=1)
    ]
    if len(parts) < _FEWEST:
        return each, []
    thirds = np.array_split(np.argsort(peaks, kind="stable"), len(GROUPS))
    groups = [
        _accuracy(found, name, [parts[place] for place in third], peaks[third], (np.nan, np.nan))
        for name, third in zip(GROUPS, thirds, strict=True)
    ]
    return each, groups


def _of_kind(found: RecordingComparison, kind: str) -> list[Residual]:
    return [one for one in found.residuals if one.signal.kind == kind]


def _speeds(moving: Sequence[Residual]) -> FloatArray:
    """Return the speeds of the run, each divided by the largest of its signal, shape (T, n)."""
    found = np.abs(np.column_stack([np.gradient(one.simulated, one.t) for one in moving]))
    largest: FloatArray = found.max(axis=0)
    scaled: FloatArray = found / np.where(largest > 0.0, largest, np.inf)
    return scaled


def _accuracy(
    found: RecordingComparison,
    name: str,
    parts: Sequence[slice],
    peaks: FloatArray,
    times: tuple[float, float],
) -> Accuracy:
    rows = np.concatenate([np.arange(part.start, part.stop) for part in parts])
    positions = [] if found.follows_measured else _of_kind(found, "position")
    reached = {one.signal.of: _below(np.abs(one.values[rows])) for one in positions}
    worst = max(reached, key=reached.__getitem__, default="")
    units = {one.signal.of: one.unit for one in positions}
    torques = _of_kind(found, "torque")
    size = sum(float(np.sum(one.recorded[rows] ** 2)) for one in torques)
    off = sum(float(np.sum(one.values[rows] ** 2)) for one in torques)
    return Accuracy(
        name=name,
        motions=len(parts),
        first=times[0],
        last=times[1],
        speeds=(float(peaks.min()), float(peaks.max())),
        position=reached.get(worst, np.nan),
        joint=worst,
        unit=units.get(worst, ""),
        tip=_tip_distance(found, rows),
        torque=float(np.sqrt(off / size)) if size > 0.0 else np.nan,
    )


def _tip_distance(found: RecordingComparison, rows: FloatArray) -> float:
    by_joint = {one.signal: one for one in _of_kind(found, "position")}
    wanted = [Signal("position", joint) for joint in found.model.joint_names]
    if found.follows_measured or not all(signal in by_joint for signal in wanted):
        return np.nan
    some = rows[:: max(1, len(rows) // _MOST_ROWS)]
    recorded, simulated = (
        found.model.tip_positions(np.column_stack([getattr(by_joint[signal], side)[some] for signal in wanted]))
        for side in ("recorded", "simulated")
    )
    return _below(np.linalg.norm(recorded - simulated, axis=1))


def _below(values: FloatArray) -> float:
    return float(np.quantile(values, 0.95))
