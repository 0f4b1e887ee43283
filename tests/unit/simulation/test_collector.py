"""Results of repetitions: metrics that a plug-in gives later, failures, and blocks that are joined."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.base.trace import Failure
from runner.simulation.results import Collector


class Watch:
    def __init__(self):
        self.joined = []

    def join(self, later):
        self.joined.append(later)


def collector(repetitions, first=0):
    return Collector(SimpleNamespace(), Watch(), repetitions, np.zeros((repetitions, 0)), first=first)


def test_metrics_that_come_later_have_no_value_before():
    found = collector(3)
    found.put([0], ("energy",), np.array([[1.0]]))
    found.put([2], ("own", "energy"), np.array([[5.0, 3.0]]))
    assert found.names == ("energy", "own")
    np.testing.assert_array_equal(found.values, [[1.0, np.nan], [np.nan, np.nan], [3.0, 5.0]])


def test_the_first_failure_counts():
    found = collector(3)
    for repetition in (2, 0, 1):
        found.fail(repetition, Failure(f"reason {repetition}", 0.1))
    assert found.failure == (0, Failure("reason 0", 0.1))


@pytest.mark.parametrize("measured", [True, False], ids=["metrics", "all failed"])
def test_blocks_are_joined_in_their_places(measured):
    whole, later = collector(2), collector(3, first=2)
    if measured:
        whole.put([0, 1], ("energy",), np.array([[1.0], [2.0]]))
        later.put([2, 4], ("energy",), np.array([[3.0], [5.0]]))
    later.fail(3, Failure("diverged", 0.2))
    whole.reserve(5)
    whole.left -= 2
    whole.join(later)
    assert (whole.left, whole.failure[0], whole.watch.joined) == (0, 3, [later.watch])
    expected = [[1.0], [2.0], [3.0], [np.nan], [5.0]] if measured else np.zeros((5, 0))
    np.testing.assert_array_equal(whole.values, expected)
