"""The time limit of a run, by a clock of the test's; one case by the real one."""

import contextlib
import os
import threading
from functools import partial

import pytest
from support.patience import PATIENCE

from runner.sweeps.deadline import STUCK, TimeLimitError, deadline

INSTANT = 0.01  # s


class Alarm:
    """The clock of a test: the first limit passes when the test says so, and the next one when what it waits for ends.

    Attributes:
        asked: The limits that were asked for, in s.
    """

    def __init__(self):
        self.asked, self._up, self._watched = [], threading.Event(), threading.Event()

    def ring(self):
        self._up.set()

    def joined(self):
        """Wait until the thread that watches has ended."""
        assert self._watched.wait(PATIENCE)
        self._watcher.join(PATIENCE)

    def wait(self, ended, seconds):
        self.asked.append(seconds)
        self._watcher = threading.current_thread()
        self._watched.set()
        assert (self._up if len(self.asked) == 1 else ended).wait(PATIENCE)
        return ended.is_set()


@pytest.fixture
def alarm():
    return Alarm()


def spin(before=lambda: None):
    before()
    for _ in range(10**9):
        pass


def rest(before):
    before()
    pause = threading.Event()
    for _ in range(int(PATIENCE / INSTANT)):
        pause.wait(INSTANT)


@pytest.mark.parametrize("busy", [spin, rest])
def test_what_takes_longer_is_interrupted(alarm, busy):
    with pytest.raises(TimeLimitError), deadline(20.0, alarm.wait):
        busy(alarm.ring)
    alarm.joined()
    assert alarm.asked == [20.0, STUCK]


def test_the_clock_of_the_machine_does_it_too():
    with pytest.raises(TimeLimitError), deadline(0.01):
        spin()


@pytest.mark.parametrize("wait", [None, threading.Event.wait], ids=["the test's clock", "the machine's"])
def test_in_a_thread_of_a_worker_too(alarm, wait):
    caught = []

    def work():
        try:
            with deadline(0.01, wait or alarm.wait):
                spin(alarm.ring)
        except TimeLimitError:
            caught.append(True)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(PATIENCE)
    assert caught == [True]


def test_a_thread_that_cannot_be_interrupted_takes_its_process_along(alarm, monkeypatch):
    codes, hold = [], threading.Event()
    monkeypatch.setattr(os, "_exit", lambda code: (codes.append(code), hold.set()))

    def wait(ended, seconds):
        alarm.asked.append(seconds)
        return False  # both limits pass at once

    def work():
        with contextlib.suppress(TimeLimitError), deadline(20.0, wait):
            hold.wait(PATIENCE)  # one call, as into compiled code

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(PATIENCE)
    assert (codes, alarm.asked) == ([1], [20.0, STUCK])


def test_code_that_catches_every_exception_is_interrupted(alarm):
    def stubborn():
        with contextlib.suppress(Exception):
            spin(alarm.ring)

    with pytest.raises(TimeLimitError), deadline(20.0, alarm.wait):
        stubborn()


def test_what_ends_in_time_is_left_alone_afterwards(alarm):
    with deadline(20.0, alarm.wait):
        pass
    alarm.ring()
    alarm.joined()
    assert alarm.asked == [20.0]


def test_without_a_limit_nobody_watches():
    before = threading.active_count()
    with deadline(None, partial(pytest.fail, "the clock was asked")):
        assert threading.active_count() == before
