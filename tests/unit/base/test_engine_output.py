"""Output of C libraries: caught line by line, and written where it belongs."""

import ctypes
import os

import pytest

from runner.base.engine_output import caught_output, quiet_stderr

C = ctypes.CDLL(None)


def test_what_c_writes_is_caught_line_by_line(capfd):
    with caught_output(1) as said:
        C.printf(b"held back by C\n")
        os.write(1, b"  at once\n\n  at once\n")
        os.write(2, b"elsewhere\n")
    assert sorted(said) == ["at once", "held back by C"]
    print("after")
    assert capfd.readouterr() == ("after\n", "elsewhere\n")


def test_what_another_thread_logs_is_written_on(capfd):
    with caught_output(2, "(Error|Warning):") as said:
        os.write(2, b"Error: no mass\nworker - the event loop was slow\nWarning: no axis\n")
    assert said == ["Error: no mass", "Warning: no axis"]
    assert capfd.readouterr().err == "worker - the event loop was slow\n"


def test_what_was_written_before_goes_where_it_was_meant_to(capfd):
    C.printf(b"before\n")
    with caught_output(1) as said:
        pass
    assert (said, capfd.readouterr().out) == ([], "before\n")


def test_an_error_ends_it_and_keeps_the_lines(capfd):
    with pytest.raises(ZeroDivisionError), caught_output(1) as said:
        print(os.write(1, b"why\n") / 0)
    os.write(1, b"heard\n")
    assert (said, capfd.readouterr().out) == (["why"], "heard\n")


def test_silence(capfd):
    with quiet_stderr():
        os.write(2, b"announced\n")
    assert capfd.readouterr() == ("", "")
