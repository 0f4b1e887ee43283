"""Rows that repeat positions: of a state slower than its log they are left out, of an arm at rest they stay."""

import numpy as np
import pytest

from runner.recordings.clock import Clock, without_repeats

PERIOD = 0.002  # s
ROWS = 5000
T = PERIOD * np.arange(ROWS)
RESOLUTION = 1e-4  # rad, of an encoder in counts


def motion(t=T, joints=3):
    """Return positions of joints that move at up to 1 rad/s, in rad, with a rest of 1 s at both ends and between."""
    way = np.clip(t - 1.0, 0.0, 3.5) + np.clip(t - 5.5, 0.0, 3.5)
    smooth = way - np.sin(2.0 * np.pi * way / 3.5) * 3.5 / (2.0 * np.pi)
    return np.sin(np.outer(smooth, 0.5 - 0.1 * np.arange(joints)))


def counts(q, resolution=RESOLUTION):
    return np.round(q / resolution) * resolution


def left(q):
    return without_repeats(Clock(T, np.arange(ROWS), []), q)


@pytest.mark.parametrize("k", range(2, 11))
@pytest.mark.parametrize("noise", [0.0, 1e-5])
@pytest.mark.parametrize("read", [lambda q: q, counts])
@pytest.mark.parametrize("joints", [1, 3])
def test_a_state_held_over_k_rows_is_taken_once(k, noise, read, joints):
    measured = read(motion(joints=joints) + noise * np.random.default_rng(k).standard_normal((ROWS, joints)))
    q = measured[np.arange(ROWS) // k * k]
    found = left(q)
    assert found.notes == [f"{ROWS - len(found.t):,} of 5,000 rows repeat the positions of the row before "
                           "and are left out"]  # fmt: skip
    assert len(found.t) == pytest.approx(ROWS / k, rel=0.02)
    steps = np.diff(found.rows)
    assert np.median(steps) == k
    assert steps.max() <= 2 * k  # nowhere a gap, at rest neither
    in_motion = (found.rows > 600) & (found.rows < 2100)
    assert np.mean(found.rows[in_motion] % k == 0) > 0.98  # each the first row of its state


@pytest.mark.parametrize("share", [0.1, 0.2, 0.35, 0.5])
def test_states_that_a_logger_missed_are_left_out_and_rest_stays(share):
    missed = np.random.default_rng(0).random(ROWS) < share
    fresh = np.maximum.accumulate(np.where(missed, 0, np.arange(ROWS)))
    found = left(motion()[fresh])
    stale = np.setdiff1d(np.flatnonzero(fresh < np.arange(ROWS)), found.rows)
    moving = (T > 1.2) & (T < 4.3)
    assert np.isin(np.flatnonzero((fresh < np.arange(ROWS)) & moving), stale).mean() > 0.99
    assert np.isin(np.flatnonzero((fresh == np.arange(ROWS)) & moving), found.rows).all()
    assert np.diff(found.t).max() <= 0.02


@pytest.mark.parametrize("between", [(1, 2), (2, 3), (3, 5)])
def test_states_at_uneven_rows_are_taken_once(between):
    first = np.cumsum(np.random.default_rng(0).integers(between[0], between[1] + 1, ROWS))
    fresh = np.maximum.accumulate(np.where(np.isin(np.arange(ROWS), first), np.arange(ROWS), 0))
    found = left(motion()[fresh])
    moving = (found.rows > 600) & (found.rows < 2100)
    assert (fresh == np.arange(ROWS))[found.rows[moving]].all()


@pytest.mark.parametrize("still", [0.0, 0.3, 1.0])
def test_a_joint_at_rest_does_not_hide_that_others_are_held(still):
    rest = counts(0.3 + still * RESOLUTION * np.random.default_rng(1).standard_normal((ROWS, 1)))
    q = np.hstack([motion(joints=2), rest])[np.arange(ROWS) // 4 * 4]
    assert len(left(q).t) == pytest.approx(ROWS / 4, rel=0.02)


@pytest.mark.parametrize("speed", [0.01, 0.03, 0.1, 0.3, 0.5, 0.7, 1.0, 1.5, 2.2, 2.8, 3.4, 5.0])
@pytest.mark.parametrize("noise", [0.0, 0.1, 0.3, 0.6, 1.0, 3.0])
@pytest.mark.parametrize("joints", [1, 2])
def test_encoders_in_slow_motion_repeat_their_counts_and_all_rows_stay(speed, noise, joints):
    rng = np.random.default_rng(3)
    way = np.outer(np.arange(ROWS) * RESOLUTION * speed, 1.0 + 0.37 * np.arange(joints))
    there_and_back = np.abs((way + 1.0) % 2.0 - 1.0) + noise * RESOLUTION * rng.standard_normal((ROWS, joints))
    assert len(left(counts(there_and_back)).t) == ROWS


@pytest.mark.parametrize("noise", [0.0, 1e-5, 1e-4, 1e-3])
def test_an_arm_at_rest_keeps_its_rows(noise):
    q = counts(0.2 + noise * np.random.default_rng(4).standard_normal((ROWS, 2)))
    assert len(left(q).t) == ROWS
    moves = counts(motion() + noise * np.random.default_rng(5).standard_normal((ROWS, 3)))
    assert len(left(moves).t) == ROWS


@pytest.mark.parametrize(("every", "stay"), [(10, False), (25, True)])
def test_few_rows_that_repeat_stay(every, stay):
    q = np.sin(T)[:, None].copy()
    q[every::every] = q[every - 1 : -1 : every]
    assert (len(left(q).t) == ROWS) == stay


def test_missing_cells_are_no_repeats():
    q = motion()[np.arange(ROWS) // 2 * 2]
    q[1000:1004, 1] = np.nan
    found = left(q)
    assert np.isin([1000, 1001, 1002, 1003], found.rows).all()
    assert len(found.t) == pytest.approx(ROWS / 2, rel=0.02)
