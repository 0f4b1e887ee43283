"""Theoretical stability limit over a heat map: omega_n h = 1."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.document import Block, Formula, Series, Text
from runner.sweeps.measurements import Axis

_FREQUENCY, _PERIOD = "controller.natural_frequency", "controller.period"
_POINTS = 400


def lines(x: Axis, y: Axis) -> list[Series]:
    """Return the lines over a map: omega_n h = 1 over natural frequency and sample time.

    Coordinates count columns and rows from 0; between two of them a value lies where its logarithm does.
    """
    if not _sampling(x, y) or x.numbers is None or y.numbers is None:
        return []
    across = np.geomspace(x.numbers[0], x.numbers[-1], _POINTS)
    upwards = 1.0 / across
    inside = (upwards >= y.numbers[0]) & (upwards <= y.numbers[-1])
    columns, rows = _place(x.numbers, across), _place(y.numbers, upwards)
    return [Series("ω_n h = 1", columns[inside], rows[inside], "dashed")] if inside.any() else []


def explained(axes: list[Axis]) -> list[Block]:
    """Return what the line of a map means, where there is one."""
    if len(axes) < 2 or not _sampling(axes[0], axes[1]):
        return []
    return [
        Text(
            "The dashed line is where theory ends the stability of a critically damped loop whose torque is held over "
            "the sample time $h$: on a plant integrated exactly"
        ),
        Formula("omega_n h < 1", "omega n times h is less than one"),
        Text(
            "and on PyBullet with $n$ steps in a sample time $4 - 4 w - w^2 / n > 0$ for $w = omega_n h$, that is "
            "$w < 0.83$ for one step and $w < 0.976$ for ten."
        ),
    ]


def _sampling(x: Axis, y: Axis) -> bool:
    """Return whether two axes are natural frequency and sample time, of the arm or of one and the same stage."""
    for first, second in ((x, y), (y, x)):
        if first.name.startswith(_FREQUENCY) and second.name.startswith(_PERIOD):
            positive = all(axis.numbers is not None and bool(axis.numbers.min() > 0) for axis in (x, y))
            return positive and first.name.removeprefix(_FREQUENCY) == second.name.removeprefix(_PERIOD)
    return False


def _place(values: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return at which column or row values lie, between two of them by their logarithms."""
    places: FloatArray = np.interp(np.log(wanted), np.log(values), np.arange(len(values), dtype=float))
    return places
