"""Units of panels: chosen by the largest value, one for panels side by side."""

import numpy as np
import pytest

from runner.reporting.charts.figure import Curves, Panel, Series
from runner.reporting.charts.scales import curves_in_readable_units

X = np.linspace(0.0, 2.0, 5)


def in_readable_units(panels, columns):
    return curves_in_readable_units(Curves("", panels, columns)).panels


def panel(height, label="error (m)", **more):
    y = height * X / 2.0
    return Panel("", "time (s)", label, [Series("a", X, y, low=-y, high=y)], **more)


@pytest.mark.parametrize(
    ("height", "label", "factor"), [(0.5, "error (m)", 1.0), (0.05, "error (mm)", 1e3), (3e-6, "error (µm)", 1e6)]
)
def test_lengths_are_shown_in_the_unit_that_fits_the_largest(height, label, factor):
    (shown,) = in_readable_units([panel(height, y_range=(-height, height))], 1)
    assert shown.y_label == label
    for name in ("y", "low", "high"):
        np.testing.assert_allclose(getattr(shown.series[0], name), factor * getattr(panel(height).series[0], name))
    assert shown.y_range == pytest.approx((-factor * height, factor * height))
    np.testing.assert_array_equal(shown.series[0].x, X)


def test_panels_beside_each_other_keep_one_unit_and_those_below_have_their_own():
    labels = [each.y_label for each in in_readable_units([panel(0.5), panel(1e-3), panel(1e-3), panel(1e-6)], 2)]
    assert labels == ["error (m)", "error (m)", "error (mm)", "error (mm)"]


@pytest.mark.parametrize("label", ["torque (N m)", "ratio", "speed (m/s)"])
def test_other_quantities_stay_as_they_are(label):
    (shown,) = in_readable_units([panel(1e-4, label)], 1)
    assert shown.y_label == label
    np.testing.assert_array_equal(shown.series[0].y, panel(1e-4).series[0].y)


def test_names_below_an_axis_have_no_unit():
    named = Panel("", "stage (s)", "y", [Series("a", np.array([0.0, 0.01]), np.ones(2))], x_names=["one", "two"])
    assert in_readable_units([named], 1) == [named]
