"""Palette: distances of colours, as readers with each colour blindness see them."""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from runner.reporting.charts import palette
from runner.reporting.charts.palette import MARKS as COLOR_MARKS

# Machado, Oliveira, Fernandes: A Physiologically-based Model for Simulation of Color Vision Deficiency, IEEE TVCG 2009,
# table 1, severity 1.0; they act on linear red, green and blue.
VISIONS = {
    "all colours": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
}
TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175], [0.0193339, 0.119192, 0.9503041]]
)
WHITE = np.array([0.95047, 1.0, 1.08883])
APART = 20.0
LEAST_CONTRAST = 3.0  # to what lies behind, of WCAG 2.1, 1.4.11


def linear(color):
    parts = np.array(to_rgb(color))
    return np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    xyz = TO_XYZ @ rgb / WHITE
    x, y, z = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def luminance(color):
    return float(TO_XYZ[1] @ linear(color))


def test_the_first_four_colours_are_told_apart_in_a_grey_print():
    """Fault of grey print: 33, 44, 53 and 57 of L*."""
    greys = [lab(np.full(3, luminance(color)))[0] for color in palette.LIGHT[:4]]
    assert min(abs(one - other) for one, other in itertools.combinations(greys, 2)) >= 12.0


def test_no_two_colours_of_a_figure_for_print_share_their_grey_and_their_mark():
    greys = [lab(np.full(3, luminance(color)))[0] for color in palette.LIGHT]
    pairs = list(itertools.combinations(range(len(greys)), 2))
    alike = [(one, other) for one, other in pairs if abs(greys[one] - greys[other]) < APART]
    assert alike  # eight colours do not all differ in grey, so that marks are needed
    assert all(COLOR_MARKS[one] != COLOR_MARKS[other] for one, other in alike)


def test_the_measure_knows_black_from_white():
    assert np.linalg.norm(lab(linear("#ffffff")) - lab(linear("#000000"))) == pytest.approx(100.0, abs=0.01)


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("colors", [palette.LIGHT, palette.DARK], ids=["light", "dark"])
def test_colours_are_told_apart_by_any_reader(colors, vision):
    seen = [lab(np.clip(VISIONS[vision] @ linear(color), 0.0, 1.0)) for color in colors]
    assert min(np.linalg.norm(one - other) for one, other in itertools.combinations(seen, 2)) >= APART


@pytest.mark.parametrize(("colors", "behind"), [(palette.LIGHT, "#ffffff"), (palette.DARK, "#14181e")])
def test_colours_stand_out_from_what_is_behind(colors, behind):
    for color in colors:
        lighter, darker = sorted((luminance(color), luminance(behind)), reverse=True)
        assert (lighter + 0.05) / (darker + 0.05) >= LEAST_CONTRAST
