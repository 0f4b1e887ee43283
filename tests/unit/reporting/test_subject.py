"""Metrics that a sweep's report compares, and the ranking of its cells."""

import numpy as np
import pytest
from support.sample_sweep import measurements, noisy, two_axes

from runner.base.errors import RunnerError
from runner.reporting.sweep.subject import choose, spans_decades

AXES = {"noise.position": [1e-4, 1e-3]}


def constant(value):
    return lambda *_: [value] * 3


def test_metrics_that_differ_are_compared_and_parts_of_them_are_not():
    metrics = {"overshoot": noisy(lambda n: 1.0 + n), "max_tracking_error_x": noisy(lambda n: 1.0 + n),
               "peak_torque_q1": noisy(lambda n: 1.0 + n), "settling_time": constant(1.0),
               "max_tracking_error": noisy(lambda n: 2.0 + n)}  # fmt: skip
    assert choose(measurements(AXES, metrics)).metrics == ("max_tracking_error", "overshoot")


def test_what_a_motion_costs_is_compared():
    names = [
        "max_tracking_error",
        "settling_time",
        "steady_state_error",
        "cross_track_error",
        "saturation_fraction",
        "energy",
    ]
    metrics = {name: noisy(lambda n: 1.0 + n) for name in names}
    assert choose(measurements(AXES, metrics)).metrics == (*names[:4], "energy")


def test_where_nothing_differs_something_is_shown():
    assert choose(measurements(AXES, {"settling_time": constant(1.0)})).metrics == ("settling_time",)


def test_metrics_asked_for_are_taken_in_that_order():
    sample = measurements(AXES, {"a": constant(1.0), "b": noisy(lambda n: 1.0 + n)})
    assert choose(sample, ["a", "b", "a"]).metrics == ("a", "b")
    with pytest.raises(RunnerError, match=r"unknown metric 'settling'. .* Did you mean 'settling_time'\?"):
        choose(measurements(AXES, {"settling_time": constant(1.0)}), ["settling"])


def test_cells_are_ranked_and_failed_ones_come_last():
    subject = two_axes(failed=[3])
    best = np.argsort([2.0**noise * 3.0**-limit for noise in range(3) for limit in range(4)], kind="stable")
    assert subject.ranked == [cell for cell in best.tolist() if cell != 3]
    assert subject.order.tolist() == [*subject.ranked, 3]


def test_a_cell_is_told_in_full():
    subject = two_axes(failed=[3])
    assert subject.cell_name(1) == "noise.position=0.0001, torque_limits.max=40"
    assert subject.hint(1).startswith("noise.position=0.0001, torque_limits.max=40; largest tracking error 0.33")
    assert subject.hint(3).endswith("largest tracking error never; largest torque never; diverged, at once")


@pytest.mark.parametrize(
    ("values", "spans"),
    [
        ([1, 10], True),
        ([1, 9.9], False),
        ([0, 100], False),
        ([-1, 100], False),
        ([1, 100, np.inf], True),
        ([np.nan], False),
    ],
)
def test_decades(values, spans):
    assert spans_decades(np.array(values, dtype=float)) is spans
