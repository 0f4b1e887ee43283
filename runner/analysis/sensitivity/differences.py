"""Central differences of metrics of whole runs, to check exact derivatives."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runner.analysis.sensitivity.analysis import Sensitivity
from runner.base.arrays import FloatArray
from runner.metrics import measure
from runner.simulation.batch import BatchResult, BatchSimulator

_LARGEST, _STEPS = 2.0**-8, 9  # fraction of the parameter and of the error; each step is half the previous one
_ROUNDING = 4e-15  # of metrics from lengths, angles or torques of about 1 in SI units


@dataclass(frozen=True)
class Differences:
    """Derivatives of a metric from differences.

    Attributes:
        derivatives: Derivative by each parameter, shape (parameters,).
        doubts: Error estimate of each derivative from its steps, shape (parameters,).
    """

    derivatives: FloatArray
    doubts: FloatArray


def differences(found: Sensitivity, names: Sequence[str]) -> dict[str, Differences]:
    """Return the derivatives of metrics by all parameters, from runs with the ordinary compiled code.

    Central differences at nine steps are extrapolated to step zero. The estimate with the best agreement between
    neighbours is taken (Ridders 1982, Advances in Engineering Software 4, 75-76).

    Args:
        found: The run with its exact derivatives.
        names: Names of the metrics.
    """
    # The tip moves by a small fraction of its error, so that the signs and the positions of maxima do not change.
    first = _LARGEST * np.minimum(1.0, found.error / np.maximum(found.moves, 1e-300))
    steps = first[:, None] * 0.5 ** np.arange(_STEPS)
    runs = [
        found.scene.at(parameter, parameter.value * (1.0 + side))
        for parameter, own in zip(found.parameters, steps.tolist(), strict=True)
        for step in own
        for side in (-step, step)
    ]
    values = np.full((len(names), len(runs)), np.nan)
    for part in BatchSimulator().simulate(runs):
        if isinstance(part, BatchResult):
            measured = measure(part.traces, part.context)
            values[:, part.places] = [measured[name] for name in names]
    pairs = values.reshape(len(names), len(found.parameters), _STEPS, 2)
    size = np.array([parameter.value for parameter in found.parameters])[:, None] * steps  # of a step
    slopes = (pairs[..., 1] - pairs[..., 0]) / (2.0 * size)
    # Gains can amplify rounding errors: the smallest steps then scatter although their error order is removed.
    smallest = (4.0 * slopes[..., -3:] - slopes[..., -4:-1]) / 3.0
    scatter = np.abs(np.diff(smallest)).max(axis=-1, keepdims=True) * np.abs(size[:, -1:])
    rounding = [
        np.maximum(_ROUNDING * max(1.0, abs(found.metrics[name])), own) / np.abs(size)
        for name, own in zip(names, scatter, strict=True)
    ]
    return {name: Differences(*_extrapolated(slopes[place], rounding[place])) for place, name in enumerate(names)}


def _extrapolated(slopes: FloatArray, rounding: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the limits of central differences and their error estimates, shapes (n,).

    Args:
        slopes: The differences, each at half the step of the previous one, shape (n, steps).
        rounding: Bound of the rounding error of each difference, shape (n, steps).
    """
    best, doubt = slopes[:, 0].copy(), np.full(len(slopes), np.inf)
    column = slopes
    for order in range(1, slopes.shape[1]):
        factor = 4.0**order
        after = (factor * column[:, 1:] - column[:, :-1]) / (factor - 1.0)
        gaps = np.maximum(np.abs(after - column[:, 1:]), np.abs(after - column[:, :-1])) + rounding[:, order:]
        for index in range(after.shape[1]):
            better = gaps[:, index] < doubt
            best[better], doubt[better] = after[better, index], gaps[better, index]
        column = after
    return best, doubt
