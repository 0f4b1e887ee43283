"""Sentences of comparisons: counts, and repetitions that differ only in noise."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.reporting.comparison.sweeps import format_count, noise_alone


@pytest.mark.parametrize(("count", "text"), [(0, "0 cells are"), (1, "1 cell is"), (2, "2 cells are")])
def test_a_number_goes_with_what_is_counted(count, text):
    assert format_count(count, "cell is", "cells are") == text


def test_nothing_but_noise_is_drawn_where_no_config_has_a_spread():
    still, spread, free = ({"mismatch": {"spread": 0.0}}, {"mismatch": {"spread": 0.1}}, {})

    def side(*configs, repetitions=2, copies=False):
        values = [(config, ()) for config in configs]
        return SimpleNamespace(repetitions=repetitions, configs=values, copies=np.full(len(configs), copies))

    assert noise_alone([side(still), side(free)])
    assert not noise_alone([side(still, spread)])
    assert not noise_alone([side(still), side(free, repetitions=1)])
    assert not noise_alone([side(still, copies=True), side(free, copies=True)])
