"""Reduction of long curves that keeps their peaks, and outlines of shaded bands."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.reporting.charts.figure import Series

POINTS = 2000
"""Most points of a drawn curve: more than a screen or a printed page can tell apart."""


def thin(series: Series, points: int = POINTS) -> Series:
    """Return the series with about `points` points at most.

    The curve is cut into equal runs of samples; of each run the samples stay where y (and x, where x goes back and
    forth, and the band's edges) is least and greatest, and one sample of every gap.

    Args:
        series: The curve, arrays of shape (T,).
        points: Most points to keep.

    Returns:
        The same series when it is short enough, otherwise a thinner one, arrays of shape (N,).
    """
    if series.x.size <= points:
        return series
    kept = _kept(_channels(series), points)
    low, high = (None if edge is None else edge[kept] for edge in (series.low, series.high))
    hints, runs = ([texts[index] for index in kept] if texts else () for texts in (series.hints, series.runs))
    return replace(series, x=series.x[kept], y=series.y[kept], low=low, high=high, hints=hints, runs=runs)


def envelope(series: Series, samples: int) -> Series:
    """Return a curve as the mean of every so many samples, with the least and the greatest of them as its band.

    So a curve that jumps at each sample is seen as wide as it jumps, and a smooth one stays a line.

    Args:
        series: The curve, arrays of shape (T,); where T is no multiple, the last group is a shorter one.
        samples: How many samples make one point.
    """
    starts = np.arange(0, series.x.size, samples)
    counts = np.diff(np.append(starts, series.x.size))
    return replace(
        series,
        x=np.add.reduceat(series.x, starts) / counts,
        y=np.add.reduceat(series.y, starts) / counts,
        low=np.minimum.reduceat(series.y, starts),
        high=np.maximum.reduceat(series.y, starts),
    )


def spaced_indices(count: int, most: int) -> list[int]:
    """Return at most `most` of the indices below `count`, evenly spaced, the first and the last among them."""
    return [int(place) for place in np.linspace(0, count - 1, min(count, most)).round()]


def usable(limits: tuple[float, float] | None, log: bool) -> bool:
    """Return whether an axis can show the given range."""
    if limits is None or not all(map(math.isfinite, limits)) or limits[0] == limits[1]:
        return False
    return not log or min(limits) > 0


def runs(mask: NDArray[np.bool_]) -> list[slice]:
    """Return the unbroken runs of True in a mask, shape (T,)."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    return [slice(int(start), int(stop)) for start, stop in zip(edges[::2], edges[1::2], strict=True)]


def band(series: Series) -> tuple[FloatArray, FloatArray] | None:
    """Return the outline of a series' shaded band as x and y, polygons parted by NaN, or None where it has no band."""
    if series.low is None or series.high is None:
        return None
    finite = np.isfinite(series.x) & np.isfinite(series.low) & np.isfinite(series.high)
    x: list[FloatArray] = []
    y: list[FloatArray] = []
    for run in runs(finite):
        x += [series.x[run], series.x[run][::-1], np.array([np.nan])]
        y += [series.high[run], series.low[run][::-1], np.array([np.nan])]
    return (np.concatenate(x)[:-1], np.concatenate(y)[:-1]) if x else None


def _channels(series: Series) -> list[FloatArray]:
    channels = [series.y]
    if np.any(np.diff(series.x[np.isfinite(series.x)]) < 0):
        channels.append(series.x)
    return channels + [edge for edge in (series.low, series.high) if edge is not None]


def _kept(channels: list[FloatArray], points: int) -> NDArray[np.intp]:
    """Return the sorted indices of the samples to keep."""
    length = channels[0].size
    count = max(1, points // (2 * len(channels)))
    edges = np.linspace(0, length, count + 1).astype(int)
    width = int(np.diff(edges).max())
    # One row per run; the last sample is repeated where a run is shorter than the longest one.
    index = np.minimum(edges[:-1, None] + np.arange(width), edges[1:, None] - 1)
    row = np.arange(count)
    kept = [np.array([0, length - 1])]
    for channel in channels:
        values = channel[index]
        missing = ~np.isfinite(values)
        kept.append(index[row, np.where(missing, np.inf, values).argmin(axis=1)])
        kept.append(index[row, np.where(missing, -np.inf, values).argmax(axis=1)])
        broken = missing.any(axis=1)
        kept.append(index[row[broken], missing.argmax(axis=1)[broken]])
    return np.unique(np.concatenate(kept))
