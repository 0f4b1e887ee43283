"""The line on a terminal, drawn on a stream that says it is one."""

import contextlib
import fcntl
import io
import os
import select
import struct
import sys
import termios
import threading
from types import SimpleNamespace

import pytest
from support.patience import PATIENCE

from runner.base import progress
from runner.base.progress import display
from runner.base.progress.display import Display, in_words
from runner.base.progress.work import Work


class Terminal(io.StringIO):
    """A terminal that both outputs of the process go to, within."""

    def isatty(self):
        return True

    @property
    def shown(self):
        return Screen(self.getvalue()).shown

    def __enter__(self):
        self._outputs = contextlib.ExitStack()
        self._outputs.enter_context(contextlib.redirect_stdout(self))
        self._outputs.enter_context(contextlib.redirect_stderr(self))
        return self

    def __exit__(self, *_):
        self._outputs.close()


class Screen:
    """What a terminal shows of a text: lines, with what carriage returns wrote over."""

    def __init__(self, text):
        self.lines = [""]
        for character in text:
            if character == "\n":
                self.lines.append("")
                self.column = 0
            elif character == "\r":
                self.column = 0
            else:
                column = getattr(self, "column", 0)
                line = self.lines[-1].ljust(column)
                self.lines[-1] = line[:column] + character + line[column + 1 :]
                self.column = column + 1

    @property
    def shown(self):
        return [line.rstrip() for line in self.lines]


@pytest.fixture
def terminal(monkeypatch):
    monkeypatch.setattr(display, "_EVERY", 3600.0)  # drawn by hand
    return Terminal()


@pytest.fixture
def work():
    found = Work(lambda: 5.0)
    found.plan({"a": 10.0, "b": 10.0})
    found.begin("a", None, 20_000, "ticks")
    return found


def test_it_says_stage_count_share_clock_and_time_left(terminal, work):
    with terminal, Display(work, terminal) as line:
        work.step(10_000)
        line.draw()
        (shown,) = terminal.shown
    assert shown.startswith("a, 10.0 of 20.0 k ticks |")
    assert shown.endswith(f"| {100.0 * work.share:.0f} %, 0:00, about {in_words(work.left)} left")


def test_a_narrow_terminal_gets_a_shorter_bar(terminal, work, monkeypatch):
    monkeypatch.setattr(display.os, "get_terminal_size", lambda _: (61, 20))
    monkeypatch.setattr(Terminal, "fileno", lambda _: 0)
    work.step(10_000)
    with terminal, Display(work, terminal) as line:
        line.draw()
        (shown,) = terminal.shown
    assert len(shown) < 60
    assert shown.endswith(" left")
    assert shown.index("|", shown.index("|") + 1) - shown.index("|") - 1 < 20


def test_it_tells_no_share_while_that_is_unknown(terminal):
    with terminal, Display(Work(lambda: 5.0), terminal) as line:
        line.draw()
        (shown,) = terminal.shown
    assert shown.split() == ["starting", "|", "|", "0:00"]


def test_nothing_is_left_of_it(terminal, work):
    with terminal, Display(work, terminal) as line:
        line.draw()
    assert terminal.shown == [""]


def test_nothing_is_left_of_it_after_an_interrupt(terminal, work):
    def interrupted():
        with Display(work, terminal) as line:
            line.draw()
            raise KeyboardInterrupt

    with terminal:
        with pytest.raises(KeyboardInterrupt):
            interrupted()
        print("runner: interrupted")
    assert terminal.shown == ["runner: interrupted", ""]


def test_what_is_printed_takes_its_place_and_it_comes_back_below(terminal, work):
    with terminal, Display(work, terminal) as line:
        line.draw()
        print("runner: 8 runs", file=sys.stderr)
        print("outputs/runs/1")
        line.draw()
        first, second, third = terminal.shown
    assert (first, second) == ("runner: 8 runs", "outputs/runs/1")
    assert third.startswith("a, 0.0 of 20.0 k")
    assert terminal.shown == ["runner: 8 runs", "outputs/runs/1", ""]


def test_it_waits_for_the_end_of_a_line_that_someone_began(terminal, work):
    with terminal, Display(work, terminal) as line:
        print("a question? ", end="")
        line.draw()
        assert terminal.shown == ["a question?"]
        print("yes")
        line.draw()
        assert len(terminal.shown) == 2


def test_its_thread_draws_and_ends_with_the_work(terminal, work, monkeypatch):
    monkeypatch.setattr(display, "_EVERY", 0.001)
    drawn = threading.Event()
    monkeypatch.setattr(Display, "draw", lambda _: drawn.set())
    before = threading.active_count()
    with terminal, Display(work, terminal):
        assert drawn.wait(PATIENCE)
    assert threading.active_count() == before


def test_a_terminal_that_is_gone_does_no_harm(work):
    other = Terminal()
    with Display(work, other) as line:
        line.draw()
        other.close()


def test_the_outputs_are_given_back_and_look_the_same_meanwhile(terminal, work):
    with terminal:
        with Display(work, terminal):
            assert sys.stdout is not terminal
            assert sys.stdout.isatty()
        assert (sys.stdout, sys.stderr) == (terminal, terminal)


def test_what_shows_its_progress_within_what_does_is_shown_once(terminal, monkeypatch):
    monkeypatch.setattr(progress, "terminal", lambda: contextlib.nullcontext(terminal))
    before = threading.active_count()
    with terminal, progress.show_progress():
        assert threading.active_count() == before + 1
        with progress.show_progress():
            assert threading.active_count() == before + 1
        assert threading.active_count() == before + 1


def test_off_a_terminal_nothing_is_shown():
    stream, before = io.StringIO(), threading.active_count()
    with contextlib.redirect_stderr(stream), progress.show_progress():
        assert sys.stderr is stream
        assert threading.active_count() == before
        progress.begin("a")
        progress.step()
    assert stream.getvalue() == ""


def test_a_notebook_shows_it_though_it_is_no_terminal(monkeypatch):
    kernel = SimpleNamespace(config={"IPKernelApp": {}})
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: kernel))
    stream = io.StringIO()
    with contextlib.redirect_stderr(stream), display.terminal() as found:
        assert found is stream
    with contextlib.redirect_stderr(stream), progress.show_progress():
        assert sys.stderr is not stream
    kernel.config = {}  # IPython in a shell
    with contextlib.redirect_stderr(stream), display.terminal() as found:
        assert found is None


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.2, "1 s"), (89.4, "89 s"), (90.0, "2 min"), (5399.0, "90 min"), (9000.0, "2.5 h")]
)
def test_durations_in_words(seconds, words):
    assert in_words(seconds) == words


@pytest.mark.parametrize("size", [(0, 0), (30, 100)])
def test_a_terminal_that_does_not_tell_its_size_is_drawn_on(monkeypatch, work, size):
    """One that another program opened, such as a container, may say that it has no lines and no columns."""
    monkeypatch.setattr(display, "_EVERY", 3600.0)
    reader, writer = os.openpty()
    fcntl.ioctl(writer, termios.TIOCSWINSZ, struct.pack("HHHH", *size, 0, 0))
    with os.fdopen(writer, "w") as stream, Display(work, stream) as line:
        work.step(10_000)
        line.draw()
        stream.flush()
        text = ""
        for _ in range(100):
            if "left" not in text:
                assert select.select([reader], [], [], PATIENCE)[0]
                text += os.read(reader, 4096).decode()
    os.close(reader)
    assert "a, 10.0 of 20.0 k ticks |" in text
