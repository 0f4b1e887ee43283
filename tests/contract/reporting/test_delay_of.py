"""The delay of a stored run."""

from types import SimpleNamespace

import pytest

from runner.papers.study.run_values import delay_of


@pytest.mark.parametrize(
    ("plant", "late"),
    [
        ({}, 0),
        ({"computation": {"delay": 3, "jitter": None, "miss": None}}, 3),
        ({"computation": {"delay": {"macro": 10, "mini": 1}, "jitter": None, "miss": None}}, 1),
    ],
)
def test_the_delay_is_that_of_the_last_loop(plant, late):
    assert delay_of(SimpleNamespace(config={"plant": plant})) == late
