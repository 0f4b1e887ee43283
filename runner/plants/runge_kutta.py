"""The classical Runge-Kutta scheme, over floats or expressions."""

from collections.abc import Callable, Sequence

from runner.base.arrays import FloatArray
from runner.symbolic.maths import Array, Scalar
from runner.symbolic.program import STAGES


def advance_stage(
    slope: Callable[[Array], Array], x: Array, h: Scalar, row: Sequence[Scalar], at: Array, sums: Sequence[Array]
) -> tuple[Array, list[Array]]:
    """Return the state of the next stage of a step, and the weighted sums of slopes so far.

    Args:
        slope: Function that returns the time derivative of a state.
        x: State at the start of the step.
        h: Step, in s.
        row: Fraction of the step for the next stage, and the weight in each sum, as in STAGES.
        at: State of this stage.
        sums: Sums before this stage.
    """
    ahead, *weights = row
    k = slope(at)
    return x + (ahead * h) * k, [total + weight * k for total, weight in zip(sums, weights, strict=True)]


def runge_kutta(slope: Callable[[Array], Array], x: FloatArray, h: float, steps: int) -> FloatArray:
    """Return the state after a number of steps.

    Args:
        slope: Function that returns the time derivative of a state.
        x: Initial state.
        h: Step, in s.
        steps: Number of steps.
    """
    rows = STAGES[:, [0, 2]].tolist()
    for _ in range(steps):
        at, sums = x, [0.0 * x]
        for row in rows:
            at, sums = advance_stage(slope, x, h, row, at, sums)
        x = x + (h / 6.0) * sums[0]
    return x
