"""Sine, cosine, arctangent and exponential against those of the platform, in units of the last place."""

import math

import numpy as np
import pytest
from support.programs import computed

from runner.symbolic.expression import angle_of, decay, sine_cosine


@pytest.mark.parametrize("reach", [0.8, 7.0, 100.0, 1e6])
def test_sine_and_cosine_are_good_to_the_last_place(reach):
    x = np.random.default_rng(0).uniform(-reach, reach, 20000)
    x[:9] = np.arange(-4, 5) * np.pi / 2.0
    found = computed("sine", lambda given: list(sine_cosine(given[0])), x[:, None])
    for ours, theirs in zip(found.T, (np.sin(x), np.cos(x)), strict=True):
        assert np.abs((ours - theirs) / np.spacing(np.abs(theirs))).max() <= 2.0
    np.testing.assert_array_equal(found[4], [math.sin(0.0), math.cos(0.0)])


def test_the_angle_of_a_point_is_good_to_the_last_places():
    generator = np.random.default_rng(0)
    angle = generator.uniform(0.0, np.pi, 20000)
    size = 10.0 ** generator.uniform(-200, 200, 20000)
    points = np.column_stack([size * np.sin(angle), size * np.cos(angle)])
    points[:3] = [0.0, 1.0], [0.0, -1.0], [1.0, 0.0]
    (found,) = computed("angle", lambda given: [angle_of(*given)], points).T
    theirs = np.arctan2(*points.T)
    assert np.abs((found - theirs) / np.spacing(theirs.clip(1e-300))).max() <= 2.0
    np.testing.assert_array_equal(found[:3], [0.0, np.pi, np.pi / 2.0])


def test_an_exponential_decay_and_what_it_leaves_are_good_to_the_last_places():
    x = np.concatenate([[0.0, 0.5], 10.0 ** np.random.default_rng(0).uniform(-300, np.log10(700.0), 20000)])
    found = computed("decay", lambda given: list(decay(given[0])), x[:, None])
    for ours, theirs in zip(found.T, (np.exp(-x), -np.expm1(-x)), strict=True):
        assert np.abs((ours - theirs) / np.spacing(theirs)).max() <= 2.0
    np.testing.assert_array_equal(computed("decay", lambda given: list(decay(given[0])), np.array([[1e9]]))[0, 1], 1.0)


def test_what_is_not_finite_gives_nothing():
    found = computed("sine", lambda given: list(sine_cosine(given[0])), np.array([[np.nan], [np.inf], [-np.inf]]))
    assert np.isnan(found).all()
