"""Thinning of curves: peaks, gaps and edges against the full curve."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.reporting.charts.figure import Series, band, envelope, spaced_indices, thin


@given(st.integers(2001, 9000), st.data())
def test_every_peak_survives(length, data):
    peak, trough = (data.draw(st.integers(0, length - 1)) for _ in range(2))
    y = np.zeros(length)
    y[peak], y[trough] = 5.0, -7.0
    thinned = thin(Series("", np.arange(length, dtype=float), y))
    assert thinned.y.max() == y.max()
    assert thinned.y.min() == y.min()
    assert thinned.x.size <= 2002
    assert np.all(np.diff(thinned.x) > 0)


def test_short_curves_stay_as_they_are():
    series = Series("", np.arange(10.0), np.arange(10.0))
    assert thin(series) is series


def test_gaps_and_edges_of_a_band_survive():
    y = np.zeros(5000)
    y[2000] = np.nan
    low, high = y - 1, y + 1
    low[1234], high[4321] = -9, 9
    thinned = thin(Series("", np.arange(5000.0), y, low=low, high=high))
    assert np.isnan(thinned.y).any()
    assert np.nanmin(thinned.low) == -9
    assert np.nanmax(thinned.high) == 9


def test_a_curve_of_nothing_but_gaps_is_no_error():
    assert np.isnan(thin(Series("", np.arange(3000.0), np.full(3000, np.nan))).y).all()


def test_a_band_is_one_polygon_for_each_unbroken_stretch():
    low = np.array([0.0, 0.0, np.nan, 0.0, 0.0])
    x, y = band(Series("", np.arange(5.0), low, low=low, high=low + 1))
    assert np.isnan(x).sum() == 1
    assert y[:4].tolist() == [1, 1, 0, 0]


def test_hints_and_runs_stay_with_their_points():
    x = np.linspace(0.0, 1.0, 5000)
    names = [f"{value:.6f}" for value in x]
    thinned = thin(Series("", x, np.sin(40 * x), hints=names, runs=names), 100)
    assert len(thinned.x) < 200
    assert list(thinned.hints) == list(thinned.runs) == [f"{value:.6f}" for value in thinned.x]


@pytest.mark.parametrize(("count", "most"), [(0, 5), (1, 5), (5, 5), (6, 5), (1000, 24), (7, 1)])
def test_evenly_spaced_places_are_different_and_reach_both_ends(count, most):
    places = spaced_indices(count, most)
    assert len(places) == len(set(places)) == min(count, most)
    assert places[:1] == ([0] if count else [])
    assert most == 1 or places[-1:] == ([count - 1] if count else [])


def test_an_envelope_shows_how_far_a_curve_jumps_and_leaves_a_smooth_one_a_line():
    x = np.arange(25.0)
    jumping = envelope(Series("a", x, np.where(np.arange(25) % 2, 5.0, -5.0), color=3), 10)
    assert (jumping.x.tolist(), jumping.color) == ([4.5, 14.5, 22.0], 3)
    assert (jumping.low.tolist(), jumping.high.tolist()) == ([-5.0] * 3, [5.0] * 3)
    np.testing.assert_allclose(jumping.y, [0.0, 0.0, -1.0])
    smooth = envelope(Series("a", x, np.ones(25)), 10)
    np.testing.assert_array_equal(smooth.low, smooth.high)
