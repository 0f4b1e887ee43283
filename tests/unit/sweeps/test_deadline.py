import contextlib
import threading
import time

import pytest

from runner.sweeps.deadline import TimeLimitError, deadline


def spin(seconds):
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        pass


@pytest.mark.parametrize("busy", [spin, lambda seconds: [time.sleep(0.01) for _ in range(int(100 * seconds))]])
def test_what_takes_longer_is_interrupted(busy):
    start = time.perf_counter()
    with pytest.raises(TimeLimitError), deadline(0.1):
        busy(30.0)
    assert 0.1 <= time.perf_counter() - start < 5.0


def test_in_a_thread_of_a_worker_too():
    caught = []

    def work():
        try:
            with deadline(0.1):
                spin(30.0)
        except TimeLimitError:
            caught.append(True)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(5.0)
    assert caught == [True]


def test_code_that_catches_every_exception_is_interrupted():
    def stubborn():
        for _ in range(1000):
            with contextlib.suppress(Exception):
                spin(0.03)

    with pytest.raises(TimeLimitError), deadline(0.1):
        stubborn()


@pytest.mark.parametrize("limit", [None, 0.2])
def test_what_ends_in_time_is_left_alone_afterwards(limit):
    for _ in range(20):
        with deadline(limit):
            spin(0.001)
    spin(0.4)
