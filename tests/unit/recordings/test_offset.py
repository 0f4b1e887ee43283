import numpy as np
import pytest

from runner.errors import RunnerError
from runner.recordings.offset import find_offset

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
