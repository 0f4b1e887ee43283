"""Holm's correction and its levels against values by hand, its order, and its error rate over true nulls."""

import numpy as np
import pytest

from runner.statistics import holm, holm_levels


def test_by_hand():
    # In order .01 .02 .03 .2: times 4, 3, 2, 1; the third, .06, is as large as the second.
    assert holm([0.03, 0.01, 0.2, 0.02]) == pytest.approx([0.06, 0.04, 0.2, 0.06])


def test_one_alone_is_left_as_it_is_and_none_is_above_one():
    assert holm([0.04]) == pytest.approx([0.04])
    assert holm([0.6, 0.9, 0.7]) == pytest.approx([1.0, 1.0, 1.0])
    assert len(holm([])) == 0


def test_a_later_one_is_never_below_an_earlier_one():
    p = np.random.default_rng(1).uniform(size=200) ** 4
    corrected = holm(p)
    assert np.all(np.diff(corrected[np.argsort(p)]) >= 0.0)
    assert np.all((corrected >= p) & (corrected <= 1.0))


def test_of_true_nulls_one_family_in_twenty_has_a_false_rejection():
    families = np.random.default_rng(2).uniform(size=(4000, 12))
    share = np.mean([holm(family).min() < 0.05 for family in families])
    assert share == pytest.approx(0.05, abs=3.0 * np.sqrt(0.05 * 0.95 / 4000))


def test_levels_by_hand():
    # In order .01 .02 .03 .2 at .05 / 4, / 3, / 2, / 1: the second, .02, is not below .0167, nor are the others then.
    assert holm_levels([0.03, 0.01, 0.2, 0.02], 0.05) == pytest.approx([0.05 / 3, 0.05 / 4, 0.05 / 3, 0.05 / 3])
    assert holm_levels([0.001, 0.002], 0.05) == pytest.approx([0.025, 0.05])
    assert len(holm_levels([], 0.05)) == 0


def test_what_is_below_its_level_is_what_is_below_alpha_when_corrected():
    for seed in range(300):
        p = np.random.default_rng(seed).uniform(size=7) ** 3
        assert ((p < holm_levels(p, 0.05)) == (holm(p) < 0.05)).all()
