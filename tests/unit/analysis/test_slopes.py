"""Derivatives of the numbers of a loop: polynomials against their own, and numbers with a kink, which have none."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.analysis.slopes import _PART, NoDerivativeError, Scene
from runner.assembly.compiled.loop_program import Setting

VALUE = 2.0
STEP = VALUE * _PART  # between two values at which numbers are taken


def slope_of(numbers):
    """Return the derivative of numbers that follow from a parameter, at its own value."""
    loop_program = SimpleNamespace(commands=SimpleNamespace(loops=()))

    def scene(value):
        return SimpleNamespace(loop_program=loop_program, setting=Setting(np.array(numbers(value)), np.zeros(1), []))

    own = scene(VALUE)
    own.at = lambda parameter, value: scene(value)
    return Scene.slope(own, SimpleNamespace(name="gain", value=VALUE)).numbers


def kink(value):
    return max(value - VALUE - 1.5 * STEP, 0.0)


def test_polynomials_of_low_degree_have_their_derivative_to_rounding():
    found = slope_of(lambda value: [value, value**2, 3.0 - value**5, 7.0, np.inf])
    assert found == pytest.approx([1.0, 2.0 * VALUE, -5.0 * VALUE**4, 0.0, 0.0], rel=1e-12)


@pytest.mark.parametrize("share", [1.0, 1e-3, 3e-6])
def test_numbers_with_a_kink_beside_the_value_have_none(share):
    with pytest.raises(NoDerivativeError, match="the numbers of the loop are no smooth functions of it"):
        slope_of(lambda value: [value**2 + share * kink(value)])


def test_a_kink_by_which_both_formulas_differ_by_less_than_1e_9_does_no_harm():
    assert slope_of(lambda value: [value**2 + 1.5e-6 * kink(value)]) == pytest.approx([2.0 * VALUE], rel=1e-6)


def test_numbers_whose_count_changes_with_the_parameter_have_none():
    with pytest.raises(NoDerivativeError, match="it changes the code of the law"):
        slope_of(lambda value: [1.0] * (2 if value > VALUE else 1))
