"""Unit check of recorded columns, by the ratio of their signals to the run's."""

from collections.abc import Iterator, Mapping

import numpy as np

from runner.base.arrays import FloatArray
from runner.recordings.columns_map import Factor, Signal
from runner.schema.units import WRITTEN

_ALIKE = 0.8  # correlation about zero, from which on a signal is a multiple of the run's
_NEAR = 1.5  # factor within which a unit explains the multiple
_SAME = 4.0  # factor within which a signal may differ for other reasons


def other_units(
    recorded: Mapping[Signal, FloatArray],
    simulated: Mapping[Signal, FloatArray],
    columns: Mapping[Signal, str],
    units: Mapping[str, Factor],
) -> Iterator[str]:
    """Yield a question for each column that would fit the run in another unit.

    Args:
        recorded: Signals of the recording, shape (T,), in SI units.
        simulated: The same of the run, at the same times.
        columns: The column of each signal.
        units: What made each column SI.
    """
    for signal, values in recorded.items():
        run = simulated[signal]
        size, run_size = float(np.linalg.norm(values)), float(np.linalg.norm(run))
        if min(size, run_size) == 0.0 or abs(float(values @ run)) < _ALIKE * size * run_size:
            continue
        multiple = size / run_size
        if 1.0 / _SAME < multiple < _SAME:
            continue
        factor, si = units[columns[signal]]
        wanted = abs(factor) / multiple
        fitting = [
            (abs(np.log(float(other) / wanted)), name)
            for name, other in WRITTEN[si].items()
            if 1.0 / _NEAR < float(other) / wanted < _NEAR
        ]
        times = f"{multiple:.4g} times" if multiple > 1.0 else f"1/{1.0 / multiple:.4g} of"
        if fitting:
            yield (
                f"columns.{columns[signal]}: the {signal.words} is {times} the run's; the column looks like "
                f"{min(fitting)[1]}: say unit: {min(fitting)[1]}"
            )
