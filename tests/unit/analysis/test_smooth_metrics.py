"""Derivatives of smooth metrics against central differences of the metrics themselves, on signals drawn at random."""

from dataclasses import replace

import numpy as np
import pytest

from runner.analysis.smooth_metrics import WITHOUT, derivatives
from runner.assembly.compiled.loops import Rows
from runner.metrics.family import MetricContext
from runner.metrics.summary import evaluate
from runner.trajectories.motion import quintic_motion

STEP, ROWS, PARAMETERS = 1e-6, 400, 2
T = np.linspace(0.0, 2.0, ROWS)


@pytest.mark.parametrize("units", [("rad", "rad"), ("rad", "m"), ("m", "m")])
def test_every_metric_that_is_not_left_out_has_the_derivative_of_its_differences(hand_made_trace, units):
    rng = np.random.default_rng(0)
    q, dq, tau, d_q, d_dq, d_tau = rng.normal(size=(6, ROWS, 2))
    tip, d_tip = rng.normal(size=(2, ROWS, 3))
    trajectory = quintic_motion(np.zeros(3), np.array([0.5, 0.2, 0.1]), 1.0)
    context = MetricContext(trajectory, 1e-3, float(T[1]))
    trace = hand_made_trace(T, tip, trajectory.sample(T)[:, 0], q, dq, tau, units=units)
    scales = np.array([1.0, -0.3])[:, None, None]
    change = Rows(scales * d_q, scales * d_dq, scales * d_tau, None, (scales * d_tip)[None])

    def moved(size):
        return evaluate(
            replace(
                trace,
                q=q + size * d_q, dq=dq + size * d_dq, tau=tau + size * d_tau, end_points=(tip + size * d_tip)[None],
            ),
            context,
        )  # fmt: skip

    above, below = moved(STEP), moved(-STEP)
    smooth = [name for name, value in above.items() if value is not None and not name.startswith(tuple(WITHOUT))]
    found = derivatives(trace, change, context)
    assert set(smooth) <= set(found)
    for name in smooth:
        by_differences = (above[name] - below[name]) / (2.0 * STEP)
        assert found[name] == pytest.approx([by_differences, -0.3 * by_differences], rel=1e-6, abs=1e-8), name
