"""Ticks in which commands arrive: lost with the probability asked for, overtaken by newer ones."""

import numpy as np
import pytest

from runner.plants.computation import ComputationConfig

COUNT = 40_000


class Fixed:
    """A generator that draws what a test says."""

    def __init__(self, uniform=(), late=()):
        self._uniform, self._late = np.array(uniform), np.array(late)

    def random(self, count):
        return self._uniform[:count]

    def choice(self, _, size, p):
        return self._late[:size]


def arrivals(generator, ticks, *, delay=0, every=1, jitter=None, miss=None):
    config = ComputationConfig(delay=delay, jitter=jitter, miss=miss)
    return config.arrivals(delay, every, ticks, generator).tolist()


def test_a_command_is_lost_where_the_draw_is_below_the_probability():
    below, above = np.nextafter(0.3, 0.0), np.nextafter(0.3, 1.0)
    assert arrivals(Fixed([0.9, below, 0.3, above, 0.0, 0.15]), 6, miss=0.3) == [0, 0, 2, 3, 3, 3]


@pytest.mark.parametrize("miss", [0.0, 0.1, 0.5, 0.9, 1.0])
def test_as_many_are_lost_as_the_probability_says(miss):
    acts = arrivals(np.random.default_rng(5), COUNT, miss=miss)
    fresh = np.count_nonzero(np.diff(acts)) / (COUNT - 1)
    assert fresh == pytest.approx(1.0 - miss, abs=5.0 * np.sqrt(miss * (1.0 - miss) / COUNT))


def test_of_two_that_come_together_the_newer_acts():
    jitter = [0.5, 0.25, 0.25]
    assert arrivals(Fixed(late=[0, 2, 1, 0, 0]), 5, jitter=jitter) == [0, 0, 0, 3, 4]  # 1, 2 and 3 come in tick 3
    assert arrivals(Fixed(late=[0, 1, 0, 2, 0]), 5, jitter=jitter) == [0, 0, 2, 2, 4]


def test_a_command_that_is_overtaken_never_acts():
    acts = arrivals(Fixed(late=[0, 3, 0, 0, 0, 0]), 6, jitter=[0.5, 0.25, 0.0, 0.25])
    assert acts == [0, 0, 2, 3, 4, 5]  # command 1 comes in tick 4


@pytest.mark.parametrize(("delay", "every", "acts"), [(0, 1, [0, 1, 2, 3]), (0, 2, [0, 0, 2, 2]), (1, 2, [0, 0, 0, 2])])
def test_commands_that_are_even_stand_until_the_next_one(delay, every, acts):
    assert arrivals(Fixed(), 4, delay=delay, every=every) == acts
