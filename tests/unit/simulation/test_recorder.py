"""The commands that act in a tick against the rows that each loop was said to act with."""

import numpy as np
import pytest

from runner.simulation.recorder import CommandTiming, constant_delay

COMMANDS = 10.0 * np.arange(4)[:, None] + np.arange(3)  # tick k, joint j: 10 k + j
JOINTS = [slice(0, 1), slice(1, 2), slice(2, 3)]
SOON, LATE = np.array([0, 1, 2, 3]), np.array([0, 0, 1, 2])


@pytest.mark.parametrize(
    "rows",
    [[SOON, SOON, SOON], [SOON, SOON, LATE], [SOON, LATE, SOON], [LATE, SOON, SOON], [SOON, LATE, LATE]],
    ids=["all alike", "the last is late", "the second is late", "the first is late", "all but the first are late"],
)
def test_each_loop_acts_with_the_command_of_its_own_row(rows):
    command_timing = CommandTiming(JOINTS, rows)
    expected = np.array([[10.0 * own[k] + joint for joint, own in enumerate(rows)] for k in range(4)])
    np.testing.assert_array_equal([command_timing.at(COMMANDS, k) for k in range(4)], expected)
    np.testing.assert_array_equal(command_timing.throughout(COMMANDS), expected)


@pytest.mark.parametrize("late", [0, 1, 3])
def test_two_loops_that_differ_in_one_tick_alone(late):
    other = SOON.copy()
    other[3] -= late
    command_timing = CommandTiming([slice(0, 2), slice(2, 3)], [SOON, other])
    np.testing.assert_array_equal(command_timing.at(COMMANDS, 3), [30.0, 31.0, 10.0 * (3 - late) + 2.0])


@pytest.mark.parametrize(
    ("delay", "rows"), [(0, [0, 1, 2, 3]), (1, [0, 0, 1, 2]), (3, [0, 0, 0, 0]), (9, [0, 0, 0, 0])]
)
def test_the_first_command_acts_until_the_delay_is_over(delay, rows):
    command_timing = constant_delay(3, delay, 4)
    np.testing.assert_array_equal(command_timing.throughout(COMMANDS), COMMANDS[rows])
