"""The delay of a stored run, under each key that it has had."""

from types import SimpleNamespace

import pandas as pd
import pytest

from runner.study.run_values import delay_of

TRACE = pd.DataFrame({"t": [0.0, 0.005, 0.01]})


@pytest.mark.parametrize(
    ("plant", "late"),
    [
        ({"command_delay": 0.01}, 2),  # of runs that were stored before there was plant.computation
        ({"command_delay": 0.0}, 0),
        ({}, 0),
        ({"computation": {"delay": 3, "jitter": None, "miss": None}}, 3),
        ({"computation": {"delay": {"macro": 10, "mini": 1}, "jitter": None, "miss": None}}, 1),
    ],
)
def test_the_delay_of_a_stored_run_is_read_whatever_its_key(plant, late):
    assert delay_of(SimpleNamespace(config={"plant": plant}, trace=TRACE)) == late
