"""Cells of a sweep that all failed."""

from dataclasses import replace

import numpy as np
from support.sample_sweep import measurements


def test_their_repetitions_are_those_of_their_configs():
    made = measurements({"controller": ["a"]}, {"rms_tracking_error": lambda law: np.ones(3)})
    assert made.repetitions == 3
    failed = replace(made, values={}, configs=[({"repetitions": 8}, np.arange(1))])
    assert failed.repetitions == 8
