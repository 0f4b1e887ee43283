"""Curves and motions of several runs: a curve for each level of an axis, with its band over the cells of that level."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.document import Curves, Panel, ReportBlock, Series
from runner.reporting.figures import LEAVES_AXES, origin, playback
from runner.store import Run

QUANTILES = (0.1, 0.9)
"""Quantiles over the cells at the edges of a band."""

_NOISY = 20.0  # length of all ways up and down over the range, from which on a curve hides another one
_MOST_SIDE_BY_SIDE, _MOST_PANELS = 3, 18
_EDGE = 0.03  # of the range, above and below the curves
Values = Callable[[Run], FloatArray]


@dataclass(frozen=True, eq=False)
class Level:
    """The runs of a level of an axis, or one run.

    Attributes:
        name: Its name.
        runs: The runs, one or more; the first one is played.
        look: Index of its colour, mark and dash.
    """

    name: str
    runs: Sequence[Run]
    look: int


def overlaid(levels: Sequence[Level], told: str = "", played: str = "") -> list[ReportBlock]:
    """Return the tip error and the torque of each joint, with the motion of the first run of each level; repetition 0.

    Noisy curves have a panel for each level, others are in the same axes. Axes have room for runs that finished; those
    of a failed run may leave them.

    Args:
        levels: The levels, up to eight, so that looks tell them apart.
        told: Sentence on the cells that are shown, for the caption; empty if the names say it.
        played: Sentence on the cells that are played.
    """
    found = [(*each, [_curve(level, each[2]) for level in levels]) for each in _quantities(levels)]
    several = 1 < len(levels) <= _MOST_SIDE_BY_SIDE and len(levels) * len(found) <= _MOST_PANELS
    noisy = [several and any(_is_noisy(series.y) for series in some) for *_, some in found]
    parted, together = ([each for each, own in zip(found, noisy, strict=True) if own is kind] for kind in (True, False))
    finished = [all(run.status == "ok" for run in level.runs) for level in levels]
    is_mixed = len(set(finished)) > 1
    panels = [
        Panel(
            title,
            "time (s)",
            label,
            some,
            y_range=_range(list(compress(some, finished))) if is_mixed else None,
            has_legend=not (parted and place),
        )
        for place, (title, label, _, some) in enumerate(together)
    ]
    for title, label, _, some in parted:
        shared = _range(list(compress(some, finished)) if is_mixed else some)
        panels += [
            Panel(f"{title}, {each.name}", "time (s)", label, [each], y_range=shared, has_legend=False) for each in some
        ]
    counts = sorted({len(level.runs) for level in levels})
    over = f"{counts[0]} cells" if counts[0] == counts[-1] else f"{counts[0]} to {counts[-1]} cells"
    band = (
        f" A curve is the median over {over}, shaded from their 10 % to their 90 % quantile." if counts[-1] > 1 else ""
    )
    caption = (
        f"Distance of the tip from its desired position, and torques; repetition 0, the one that is stored.{told}{band}"
        f"{f' {LEAVES_AXES}' if is_mixed else ''}"
    )
    first, *others = [
        replace(playback(level.runs[0], "", has_still=not place), name=level.name, look=level.look)
        for place, level in enumerate(levels)
    ]
    still = f" The still picture shows {first.name}." if others else ""
    motion = f"The motion{'s' if others else ''} of repetition 0{f': {played}' if played else ''}.{still}"
    columns = len(levels) if parted else 2
    return [
        Curves(caption, panels, columns, origin(levels[0].runs[0])),
        replace(first, caption=motion, others=others),
    ]


def _quantities(levels: Sequence[Level]) -> Iterator[tuple[str, str, Values]]:
    """Yield title, label and values of each quantity over time: the tip error and, of one unit, the joints' torques."""
    yield "Tip error", "tip error (m)", lambda run: np.linalg.norm(run.vector("error"), axis=1)
    runs = [run for level in levels for run in level.runs]
    joints = min(len(run.provenance["joints"]) for run in runs)
    units = {run.units[f"tau{joint + 1}"] for run in runs for joint in range(joints)}
    for joint in range(joints) if len(units) == 1 else ():
        (unit,) = units
        what, name = "Force" if unit == "N" else "Torque", runs[0].provenance["joints"][joint]
        yield (
            f"{what} of {name}",
            f"{what.lower()} of {name} ({unit})",
            lambda run, joint=joint: run.joints("tau")[:, joint],  # type: ignore[misc]
        )


def _curve(level: Level, values: Values) -> Series:
    """Return the curve of a run; of several runs their median, with its band, over the time of the longest."""
    if len(level.runs) == 1:
        return Series(level.name, level.runs[0].t, values(level.runs[0]), color=level.look, level=True)
    t = max((run.t for run in level.runs), key=lambda each: float(each[-1]))
    rows = [np.interp(t, run.t, values(run), right=np.nan) for run in level.runs]
    low, middle, high = np.nanquantile(np.array(rows), [QUANTILES[0], 0.5, QUANTILES[1]], axis=0)
    return Series(level.name, t, middle, low=low, high=high, color=level.look, level=True)


def _is_noisy(y: FloatArray) -> bool:
    """Return True if a curve goes up and down so often that it hides other curves."""
    sound = y[np.isfinite(y)]
    return bool(sound.size and np.abs(np.diff(sound)).sum() > _NOISY * np.ptp(sound) > 0.0)


def _range(some: Sequence[Series]) -> tuple[float, float] | None:
    """Return the range that all curves and bands need; None without any number."""
    parts = [part for each in some for part in (each.y, each.low, each.high) if part is not None]
    drawn = np.concatenate([part[np.isfinite(part)] for part in parts])
    if not drawn.size or not np.ptp(drawn):
        return None
    room = _EDGE * float(np.ptp(drawn))
    return float(drawn.min()) - room, float(drawn.max()) + room
