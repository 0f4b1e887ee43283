"""Columns of numbers and words on a terminal."""

import numpy as np

from runner.reporting.answers import HEADER, judge
from runner.reporting.asked import AskedComparison
from runner.reporting.comparison.sweeps import letter
from runner.reporting.table import Number
from runner.statistics import compare_paired


def test_an_answer_fills_its_columns():
    samples = (np.arange(6.0), np.arange(6.0) + 2.0), (np.zeros(2), np.ones(2))
    shifted, few = (
        judge([AskedComparison("energy", "J", compare_paired(*each))], ["energy"])[0].plain_cells for each in samples
    )
    assert shifted == [Number(2.0), Number(None, 2.0, 2.0), "6", "1.00", "0.031", "larger"]
    assert len(shifted) == len(HEADER) + 1
    assert few == [Number(1.0), Number(None), "2", "1.00", "-", "too few pairs to say (2 of 6)"]


def test_folders_are_called_by_letters():
    assert [letter(place) for place in (0, 1, 25, 26)] == ["A", "B", "Z", "27"]
