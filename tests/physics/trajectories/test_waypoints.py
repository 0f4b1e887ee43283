"""Motion through way points: least jerk, continuity and times."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.base.errors import ConfigError
from runner.trajectories.motion import quintic_motion
from runner.trajectories.splines import minimum_jerk
from runner.trajectories.waypoints import WaypointsConfig, build

START = np.array([0.3, -0.2, 0.4])
POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [-1.0, 1.0, 1.0], [0.0, 1.0, -1.0]])
TIMES = np.array([0.0, 0.5, 1.0, 2.2, 3.0])


def waypoints(**changes):
    values = {"origin": None, "scale": 1.0, "points": POINTS[1:].tolist(), "time_shares": None, "duration": 4.0}
    return build(WaypointsConfig(kind="waypoints", start=None, **(values | changes)), START)


@given(st.lists(st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3), min_size=5, max_size=5).map(np.array))
def test_it_passes_its_points_at_their_times_from_rest_to_rest(points):
    motion = minimum_jerk(points, TIMES).sample(TIMES)
    np.testing.assert_allclose(motion[:, 0], points, atol=1e-12)
    np.testing.assert_allclose(motion[[0, -1], 1:], 0.0, atol=1e-10)


def test_between_its_ends_it_does_not_stop():
    assert np.linalg.norm(minimum_jerk(POINTS, TIMES).sample(TIMES[1:-1])[:, 1], axis=1).min() > 1.0


def test_four_derivatives_are_continuous_at_the_way_points():
    spline = minimum_jerk(POINTS, TIMES).orders[0].func
    for order in range(5):
        before, after = (spline(TIMES[1:-1] + side, order) for side in (-1e-12, 1e-12))
        np.testing.assert_allclose(before, after, atol=1e-7)
    assert np.abs(spline(TIMES[1:-1] + 1e-12, 5) - spline(TIMES[1:-1] - 1e-12, 5)).max() > 1.0


def test_no_other_motion_through_the_points_has_less_jerk():
    """The jerk's product with that of any change that keeps points, times and rest vanishes (Euler and Lagrange)."""
    spline = minimum_jerk(POINTS, TIMES).orders[0].func
    # Vanishes at every way-point, with two derivatives at the ends; two such changes, one skewed.
    change = np.polynomial.Polynomial.fromroots([*TIMES, 0.0, 0.0, 3.0, 3.0])
    for variation in (change, change * np.polynomial.Polynomial([1.0, -2.0, 0.5])):
        nodes, weights = np.polynomial.legendre.leggauss(12)
        product, own, other = np.zeros(3), np.zeros(3), 0.0
        for a, b in pairwise(TIMES):
            t, w = (a + b) / 2 + (b - a) / 2 * nodes, (b - a) / 2 * weights
            jerk, jerk_change = spline(t, 3), variation.deriv(3)(t)
            product += (w * jerk_change) @ jerk
            own += w @ jerk**2
            other += float(w @ jerk_change**2)
        np.testing.assert_allclose(product / np.sqrt(own * other), 0.0, atol=1e-11)


def test_with_one_point_it_is_the_quintic():
    one, t = waypoints(points=[[1.0, 2.0, 3.0]]), np.linspace(0.0, 5.0, 51)
    quintic = quintic_motion(START, START + np.array([1.0, 2.0, 3.0]), 4.0)
    np.testing.assert_allclose(one.sample(t), quintic.sample(t), atol=1e-12)
    points = START + np.random.default_rng(3).normal(size=(50, 3))
    np.testing.assert_allclose(one.distance_to_path(points), quintic.distance_to_path(points), atol=1e-9)


def passed(trajectory, parts):
    """Times of the start and of each way-point."""
    return trajectory.places[:: (len(trajectory.places) - 1) // parts]


def points_of(trajectory):
    return trajectory.sample(passed(trajectory, len(POINTS) - 1))[:, 0]


def test_equal_ways_take_equal_times_and_longer_ones_longer():
    trajectory = waypoints(points=[[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 2.0]])
    np.testing.assert_allclose(passed(trajectory, 3), [0.0, 1.0, 2.0, 4.0])


def test_times_may_be_given_as_shares():
    np.testing.assert_allclose(passed(waypoints(time_shares=[0.1, 0.2, 0.6, 1.0]), 4), [0.0, 0.4, 0.8, 2.4, 4.0])


def test_points_are_measured_from_the_start_or_from_an_origin_in_units_of_scale():
    np.testing.assert_allclose(points_of(waypoints(scale=0.1)), START + 0.1 * POINTS, atol=1e-12)
    from_base = points_of(waypoints(origin=[0.0, 0.0, 0.5], scale=0.5))
    np.testing.assert_allclose(from_base[0], START, atol=1e-15)
    np.testing.assert_allclose(from_base[1:], 0.5 * POINTS[1:] + [0.0, 0.0, 0.5], atol=1e-12)


def test_it_may_come_back_to_a_point_and_to_its_start():
    there_and_back = waypoints(points=[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(there_and_back.goal, START)
    path = there_and_back.sample(np.linspace(0.0, 4.0, 777))[:, 0]
    assert there_and_back.distance_to_path(path).max() < 1e-14


def test_the_distance_beyond_its_end_goes_to_the_end():
    trajectory = waypoints(points=[[1.0, 0.0, 0.0]])
    points = np.array([[4.0, 4.0, 0.0], [-3.0, 0.0, 4.0], [1.0, 0.0, 0.0]])
    found = trajectory.distance_to_path(START + points)
    np.testing.assert_allclose(found, [5.0, 5.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], "trajectory.points.0: lies where the start does, at "),
        (
            [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, 0.0]],
            "trajectory.points.2: lies where trajectory.points.1 does",
        ),
        ([[0.0, 0.0, 0.0]], "trajectory.points.0: lies where the start does"),
    ],
)
def test_points_in_succession_must_differ(points, message):
    with pytest.raises(ConfigError, match=message):
        waypoints(points=points)
