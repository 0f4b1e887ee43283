"""Torques at their limits: metrics that show a limit instead of a law, and the joint that is at it.

The largest torque is not compared if either law is at the limit at any tick. What else follows from torques is not
compared if the fraction of ticks at the limit exceeds the threshold of the caveat `saturation`.
"""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from runner.base.quantities import number
from runner.sweeps.measurements import Measurements

PEAKS = ("peak_torque", "peak_joint_force")
"""Metrics that are not compared if a joint is at its limit at any tick."""

FOLLOWING = ("rms_torque", "torque_chatter", "rms_joint_force", "force_chatter", "energy", "control_effort",
             "force_effort")  # fmt: skip
"""Metrics that are not compared if a joint is at its limit at more ticks than the caveat `saturation` allows."""

SATURATION = "saturation_fraction"
_THRESHOLD = "caveats.saturation.share"
_DEFAULT = 0.1  # of the threshold, for configs without it
_PART = re.compile(r"(.*?)(_q\d+)?$")
Cells = NDArray[np.intp]
Sides = Sequence[tuple[Measurements, Cells]]


def find_limit(sides: Sides, metric: str) -> str:
    """Return the joint that is at its torque limit, and how often, if a metric shows the limit; else "".

    Args:
        sides: The compared cells, shape (n,), of each sweep.
        metric: Name of the metric.
    """
    name, part = _split(metric)
    if name not in (*PEAKS, *FOLLOWING):
        return ""
    beyond = any(
        np.any(_shares(side, cells, f"{SATURATION}{part}") > (0.0 if name in PEAKS else _thresholds(side, cells)))
        for side, cells in sides
    )
    return describe_limit(sides, part) if beyond else ""


def is_saturated(sides: Sides) -> bool:
    """Return True if a joint is at its limit at more ticks than the caveat `saturation` allows, in any cell."""
    return any(np.any(_shares(side, cells, SATURATION) > _thresholds(side, cells)) for side, cells in sides)


def limiting_joint(sides: Sides, part: str = "") -> tuple[str, str]:
    """Return the joint that is most often at its limit, and how often: "joint 2", "87 N m at up to 23 % of the ticks".

    Both are empty if no joint is known to be at its limit.

    Args:
        sides: The compared cells of each sweep.
        part: Part of a metric's name for one joint, such as "_q2"; empty for all joints.
    """
    worst, joint, limit = 0.0, "", ""
    for side, cells in sides:
        for name in side.values:
            if name.startswith(f"{SATURATION}_q") and part in ("", name.removeprefix(SATURATION)):
                shares = _shares(side, cells, name)
                if shares.size and shares.max() > worst:
                    worst, joint = float(shares.max()), name.rpartition("_q")[2]
                    limit = _limit_of(side, int(cells[int(shares.argmax())]), joint)
    return (f"joint {joint}", f"{limit} at up to {number(100.0 * worst, 2)} % of the ticks") if joint else ("", "")


def describe_limit(sides: Sides, part: str = "") -> str:
    """Return the joint that is most often at its limit, as "joint 2 is at its limit of 87 N m at 23 % of the ticks"."""
    joint, often = limiting_joint(sides, part)
    return f"{joint} is at its limit of {often}" if joint else "a joint is at its torque limit"


def _split(metric: str) -> tuple[str, str]:
    found = _PART.fullmatch(metric)
    return (found[1], found[2] or "") if found else (metric, "")


def _shares(side: Measurements, cells: Cells, name: str) -> NDArray[np.float64]:
    """Return the largest fraction of ticks at the limit over the repetitions of each cell, shape (n,); 0 if unknown."""
    if name not in side.values:
        return np.zeros(len(cells))
    values = side.values[name][cells]
    largest: NDArray[np.float64] = np.where(np.isfinite(values), values, 0.0).max(axis=1, initial=0.0)
    return largest


def _thresholds(side: Measurements, cells: Cells) -> NDArray[np.float64]:
    if not side.configs:
        return np.full(len(cells), _DEFAULT)
    known = [_DEFAULT if value is None else float(value) for value in side.resolved(_THRESHOLD)]
    return np.array(known)[side.config_of_cells[cells]]


def _limit_of(side: Measurements, cell: int, joint: str) -> str:
    """Return the limit of a joint that reaches it, such as "87 N m"."""
    for name, unit in (("peak_torque", "N m"), ("peak_joint_force", "N")):
        if f"{name}_q{joint}" in side.values:
            values = side.values[f"{name}_q{joint}"][cell]
            return f"{number(float(values[np.isfinite(values)].max()), 4)} {unit}"
    return "its torque"
