"""Traces of one run and of several: parts of their runs and of their ticks."""

from dataclasses import replace

import numpy as np
import pytest

from runner.base.trace import ContactSignals, Failure

T = np.arange(11) * 0.1
BY_RUN = ("q", "dq", "tau", "limits")


@pytest.fixture
def traces(hand_made_trace):
    """Three runs with a common desired motion."""
    rows = np.arange(11.0)[:, None]
    each = [hand_made_trace(T, q=run + rows, dq=-rows, tau=run * rows, tip=run, limits=run) for run in range(3)]
    own = {name: np.array([getattr(trace, name) for trace in each]) for name in BY_RUN}
    return each, replace(each[0], **own, end_points=np.stack([trace.end_points for trace in each], axis=1))


def assert_equal(found, expected):
    for name, value in vars(expected).items():
        np.testing.assert_array_equal(getattr(found, name), value, err_msg=name)


def test_a_run_is_the_same_in_and_out_of_a_batch(traces):
    each, several = traces
    for run, trace in enumerate(each):
        assert_equal(several[run], trace)
        assert_equal(trace[None], several[run : run + 1])
        assert_equal(trace[None][0], trace)
    assert_equal(several[[2, 0]][0], each[2])


def test_a_desired_motion_of_each_run_is_taken_too(traces):
    each, several = traces
    desired = np.arange(3.0)[:, None, None, None] + several.desired
    own = replace(several, desired=desired)
    np.testing.assert_array_equal(own[1].desired, desired[1])
    np.testing.assert_array_equal(own[1].error, desired[1, :, 0] - each[1].tip)
    np.testing.assert_array_equal(own.error_by_axis[1], own[1].error.T)


def test_some_ticks_have_every_signal(hand_made_trace):
    whole = hand_made_trace(T, q=np.arange(11.0)[:, None])
    contact = ContactSignals(*(place + np.zeros((11, 6)) + T[:, None] for place in range(5)))
    whole = replace(whole, contact=contact, q_command=whole.q + 1.0, law_seconds=T + 2.0)
    part = whole.during(slice(2, 6))
    for name in ("t", "q", "dq", "tau", "q_command", "desired", "law_seconds"):
        np.testing.assert_array_equal(getattr(part, name), getattr(whole, name)[2:6], err_msg=name)
    np.testing.assert_array_equal(part.end_points, whole.end_points[:, 2:6])
    np.testing.assert_array_equal(part.contact.load, contact.load[2:6])
    assert len(part.tick_seconds) == 3


@pytest.mark.parametrize(("time", "rows"), [(0.0, 1), (0.3, 4), (1.0, 11)])
def test_it_ends_with_the_row_of_its_failure(hand_made_trace, time, rows):
    failure = Failure("why", T[round(10 * time)], "q1")
    ended = hand_made_trace(T).ended(failure)
    assert (len(ended.t), len(ended.tick_seconds), ended.failure) == (rows, rows - 1, failure)
