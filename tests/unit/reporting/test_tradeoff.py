"""Trade-off between two metrics: the Pareto front against its definition."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from support.sample_sweep import measurements, noisy, two_axes

from runner.reporting.sweep.subject import choose
from runner.reporting.sweep.tradeoff import front, pair, section

COORDINATES = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=30)


def dominated(point, others):
    return any(a <= point[0] and b <= point[1] and (a, b) != point for a, b in others)


@given(COORDINATES)
def test_no_point_beats_one_of_the_front_and_every_other_is_beaten(points):
    a, b = np.array(points, dtype=float).T
    chosen = front(a, b)
    assert chosen
    assert not any(dominated(points[index], points) for index in chosen)
    on_front = {points[index] for index in chosen}
    assert all(point in on_front or dominated(point, points) for point in points)


def test_the_front_goes_down_and_leaves_out_what_has_no_number():
    a = np.array([3.0, 1.0, np.inf, 2.0, np.nan])
    b = np.array([1.0, 9.0, 0.0, np.inf, 0.0])
    assert front(a, b) == [1, 0]


def test_an_error_is_traded_off_against_its_cost():
    axes = {"controller.period": [0.01, 0.02], "torque_limits.max": [20.0, 40.0]}
    metrics = {"max_tracking_error": noisy(lambda period, limit: 1.0 + period),
               "peak_torque": noisy(lambda period, limit: 1.0 + limit)}  # fmt: skip
    assert pair(choose(measurements(axes, metrics))) == ("max_tracking_error", "peak_torque")
    assert pair(choose(measurements(axes, {"a": metrics["max_tracking_error"]}))) is None


def test_no_front_runs_over_a_condition():
    assert pair(two_axes()) is None  # over the noise, which nobody chooses


def test_the_section_lists_the_front():
    subject = two_axes()
    made = section(subject, ("max_tracking_error", "peak_torque"))
    text, figure, table = made.blocks
    assert "has 4 of 12 cells" in text.text
    assert [row[0] for row in table.rows] == [
        f"noise.position=0.0001, torque_limits.max={limit}" for limit in (80, 60, 40, 20)
    ]
    cells, best = figure.panels[0].series
    assert len(cells.runs) == len(cells.hints) == len(cells.x) == 12
    assert best.runs[0] == subject.measurements.hashes[3]
