"""When a run began on the clock of a recording: against the time by which its motion was moved."""

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.recordings.offset import find_lag, find_offset
from tools.log_offsets import is_refused, judge, make_log

RUN_T = np.arange(0.0, 4.0005, 1e-3)
NAMES = ("columns.a", "columns.b")


def motion(t):
    """Two joints that swing, and rest before 0 s and after 4 s."""
    inside = np.clip(t, 0.0, 4.0)
    window = np.sin(np.pi * inside / 4.0) ** 2
    return np.column_stack([window * np.sin(7.0 * inside), 0.3 * window * np.cos(3.0 * inside + inside**2)])


def recorded(start, rate=200.0, first=0.0, last=6.0):
    t = np.arange(first, last, 1.0 / rate)
    return t, motion(t - start)


@pytest.mark.parametrize("start", [1.2345, 0.0, -0.3217, 2.4801])
@pytest.mark.parametrize("rate", [90.0, 1000.0])
def test_the_start_of_a_motion_is_found_between_samples(start, rate):
    t, signals = recorded(start, rate)
    noise = np.random.default_rng(1).normal(0.0, 1e-4, signals.shape)
    found = find_offset(t, signals + noise, RUN_T, motion(RUN_T), NAMES)
    assert found.start == pytest.approx(start, abs=0.02 / rate)
    assert found.rivals == ()
    assert found.correlations.max() == pytest.approx(1.0, abs=0.02)


def test_encoders_with_another_zero_and_a_part_of_the_motion_do_no_harm():
    t, signals = recorded(-1.7, last=1.5)
    found = find_offset(t, signals + np.array([0.5, -0.2]), RUN_T, motion(RUN_T), NAMES)
    assert found.start == pytest.approx(-1.7, abs=1e-4)


def test_the_clock_of_the_run_need_not_begin_at_zero():
    t, signals = recorded(1.2345)
    found = find_offset(t, signals, RUN_T + 10.0, motion(RUN_T), NAMES)
    assert found.start == pytest.approx(1.2345 - 10.0, abs=1e-4)
    assert found.lags[np.argmax(found.correlations)] == pytest.approx(found.start, abs=0.005)


def test_positions_decide_over_more_than_a_sample_of_the_recording():
    """A small fast swing, 8 ms ahead of the large slow one, dominates the speeds' changes and so their correlation.

    The start is that of least squares over positions, 6 ms from where the speeds correlate best; a sample is 5 ms.
    """

    def swings(t, early=0.0):
        inside, ahead = (np.clip(times, 0.0, 4.0) for times in (t, t + early))
        slow = np.sin(np.pi * inside / 4.0) ** 2 * np.sin(2.0 * inside)
        return (slow + 0.02 * np.sin(np.pi * ahead / 4.0) ** 2 * np.sin(25.0 * ahead))[:, None]

    t = np.arange(0.0, 6.0, 0.005)
    found = find_offset(t, swings(t - 1.0, early=0.008), RUN_T, swings(RUN_T), ["columns.a"])
    starts = 1.0 + np.arange(-0.002, 0.0005, 1e-5)
    apart = [np.sum((swings(t - 1.0, early=0.008) - swings(t - start)) ** 2) for start in starts]
    assert found.start == pytest.approx(starts[np.argmin(apart)], abs=2e-5)
    assert found.start - found.lags[np.argmax(found.correlations)] > 1.1 * 0.005


@pytest.mark.parametrize(("other", "against"), [(0.2, True), (0.3, False)])
def test_a_signal_moves_against_the_run_if_its_speeds_correlate_by_less_than_minus_a_half(other, against):
    """Part of the fourth signal moves otherwise: its correlation is -0.65 and -0.46."""
    t, signals = recorded(1.0)
    inside = np.clip(t - 1.0, 0.0, 4.0)
    elsewhere = other * np.sin(np.pi * inside / 4.0) ** 2 * np.sin(11.0 * inside)
    columns = np.column_stack([signals, signals[:, 0], elsewhere - signals[:, 1]])
    given = (t, columns, RUN_T, motion(RUN_T)[:, [0, 1, 0, 1]], [*NAMES, "columns.c", "columns.d"])
    if against:
        with pytest.raises(RunnerError, match=r"^columns.d: moves against the run"):
            find_offset(*given)
    else:
        assert find_offset(*given).start == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("lasts", "speeds"), [(6.0, (1.0, 1.3)), (12.0, (0.5, 0.65)), (10.0, (0.3, 0.39))], ids=["6 s", "12 s", "10 s"]
)
def test_a_motion_that_is_cut_off_begins_where_it_does(lasts, speeds):
    """The correlation of the speeds has its maximum 9 ms from it, as the end weighs against it."""

    def swings(t):
        return np.column_stack([0.3 * (1.0 - np.cos(speeds[0] * t)), 0.2 * (1.0 - np.cos(speeds[1] * t))])

    t, run_t = np.arange(0.0, lasts, 2e-3), np.arange(0.0, lasts, 1e-3)
    found = find_offset(t, swings(t), run_t, swings(run_t), NAMES)
    assert found.start == pytest.approx(0.0, abs=1e-6)
    assert (found.rivals, found.open_ended) == ((), False)


@pytest.mark.parametrize("seed", range(6))
def test_offsets_of_made_up_logs_are_right_or_undetermined(seed):
    """A share of `python -m tools log_offsets`."""
    log = make_log(seed)
    assert judge(log) in (["right"] if log.at_rest else ["right", "undetermined"])
    assert is_refused(make_log(seed, periodic=True), seed)


@pytest.mark.parametrize(("commanded", "lag"), [(np.sin, 0.02), (np.cos, -0.01), (lambda t: t**2, 0.25)])
def test_a_lag_is_that_of_the_same_motion_later(commanded, lag):
    t = np.arange(0.0, 5.0, 0.004)
    assert find_lag(t, commanded(t - lag) + 0.1, commanded(t)) == pytest.approx(lag, abs=1e-5)


def test_a_motion_that_repeats_itself_has_rivals():
    run = np.sin(2.0 * np.pi * RUN_T)[:, None]
    t = np.arange(0.0, 12.0, 0.005)
    found = find_offset(t, np.sin(2.0 * np.pi * t)[:, None], RUN_T, run, ["columns.a"])
    assert len(found.rivals) >= 7
    assert np.array([found.start, *found.rivals]) % 1.0 == pytest.approx(
        np.round(np.array([found.start, *found.rivals]) % 1.0), abs=0.01
    )


@pytest.mark.parametrize(
    ("change", "wanted"),
    [
        (lambda t, q: (t, q * [1.0, -1.0]), r"columns.b: moves against the run; turn the sign of the column"),
        (
            lambda t, q: (t, q[:, ::-1]),
            r"columns.a moves as columns.b should, columns.b moves as columns.a should: are the joints",
        ),
        (
            lambda t, q: (2.0 * t, q),
            r"at most at 100 Hz, and by 1.00 at about (199|200) Hz: is that the rate of its rows\?",
        ),
        (
            lambda t, q: (0.25 * t, q),
            r"at most at 800 Hz, and by 1.00 at about (199|200) Hz: is that the rate of its rows\?",
        ),
        (
            lambda t, q: (1.05 * t, q),
            r"at most at 190.5 Hz, and by 1.00 at about (199|200) Hz: is that the rate of its rows\?",
        ),
        (
            lambda t, q: (1.2 * t, q),
            r"at most at 166.7 Hz, and by 1.00 at about (199|200) Hz: is that the rate of its rows\?",
        ),
        (lambda t, q: (1000.0 * t, q), r"are its times in ms\? say unit: ms"),
        (
            lambda t, q: (1e-3 * t, q),
            r"too short: it lasts 0.00[56].* s, and the run 4 s; needed: 1 s or more.*unit of",
        ),
        (lambda t, q: (t, motion(17.0 * t % 4.0)), r"does not move as the run does: .* needed: 0.5"),
        (lambda t, q: (t, 0.0 * q), r"does not move as the run does: its speeds correlate with the run's by 0.00"),
    ],
)
def test_recordings_of_something_else_are_refused(change, wanted):
    with pytest.raises(RunnerError, match=wanted):
        find_offset(*change(*recorded(1.0)), RUN_T, motion(RUN_T), NAMES)


def test_a_run_that_stands_still():
    with pytest.raises(RunnerError, match="the run stands still"):
        find_offset(*recorded(1.0), RUN_T, 0.0 * motion(RUN_T), NAMES)


@pytest.mark.parametrize("clock", [0.0, 1.7e9])
def test_the_start_is_as_sharp_on_a_clock_that_began_in_1970(clock):
    t, signals = recorded(1.2345)
    found = find_offset(t + clock, signals, RUN_T, motion(RUN_T), NAMES)
    assert found.start - clock == pytest.approx(1.2345, abs=2e-6)
