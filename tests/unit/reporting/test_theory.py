"""Lines of theory in maps: frequency times sample time equal to one."""

import numpy as np
import pytest

from runner.reporting.sweep.maps import theory_lines, theory_text
from runner.store.axes import Axis


def axis(name, values):
    return Axis(name, values, np.zeros(1, dtype=int))


FREQUENCY = axis("controller.natural_frequency", [10.0, 20.0, 40.0, 80.0])
PERIOD = axis("controller.period", [0.0125, 0.025, 0.05, 0.1])


@pytest.mark.parametrize(("x", "y"), [(FREQUENCY, PERIOD), (PERIOD, FREQUENCY)])
def test_the_product_is_one_along_the_line(x, y):
    (line,) = theory_lines(x, y)
    along = [np.exp(np.interp(places, np.arange(4), np.log(axis.values)))
             for places, axis in ((line.x, x), (line.y, y))]  # fmt: skip
    assert along[0] * along[1] == pytest.approx(np.ones(len(line.x)), rel=1e-9)
    assert (line.x[0], line.y[0]) == pytest.approx((0.0, 3.0), abs=0.02)  # 10 * 0.1 and 80 * 0.0125: the corners
    assert (line.x[-1], line.y[-1]) == pytest.approx((3.0, 0.0), abs=0.02)


def test_a_line_outside_the_grid_is_not_drawn():
    assert theory_lines(FREQUENCY, axis("controller.period", [0.001, 0.002])) == []


@pytest.mark.parametrize(
    ("x", "y", "drawn"),
    [
        ("controller.natural_frequency.macro", "controller.period.macro", True),
        ("controller.natural_frequency.macro", "controller.period.mini", False),
        ("controller.natural_frequency", "controller.damping_ratio", False),
        ("noise.position", "controller.period", False),
    ],
)
def test_only_frequency_and_sample_time_of_one_loop_have_it(x, y, drawn):
    first, second = axis(x, FREQUENCY.values), axis(y, PERIOD.values)
    assert bool(theory_lines(first, second)) is drawn
    assert bool(theory_text([first, second])) is drawn


def test_texts_have_no_line():
    assert theory_lines(axis(FREQUENCY.name, ["a", "b"]), PERIOD) == []
