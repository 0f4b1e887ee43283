"""The line on a terminal, drawn on a stream that reports to be one."""

import contextlib
import fcntl
import io
import os
import select
import struct
import sys
import termios
import threading
import time
from types import SimpleNamespace

import pytest
from support.patience import PATIENCE

from runner.base import progress
from runner.base.progress import _Display as Display
from runner.base.progress import _Stage as Stage


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
    """The lines that a terminal shows of its output, after carriage returns."""

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
    monkeypatch.setattr(progress, "_EVERY", 3600.0)  # drawn by hand
    return Terminal()


def shown(stream, **stage):
    """Return a display on a stream, whose stage began 10 s ago."""
    display = Display(stream)
    display.stage = Stage(**({"name": "a", "total": 20_000, "unit": "ticks", "began": time.time() - 10.0} | stage))
    return display


def test_it_shows_stage_count_and_the_time_that_is_left(terminal):
    with terminal, shown(terminal) as display:
        display.stage.reached += 10_000
        display.draw()
        (line,) = terminal.shown
    assert line.startswith("a:  50%|")
    assert "| 10.0k/20.0k [00:10<00:10, " in line
    assert line.endswith(" ticks/s]")


def test_a_count_is_asked_for_and_never_falls(terminal):
    counts = iter([3, 2, 8, 30])
    with terminal, shown(terminal, total=10, count=lambda: next(counts)) as display:
        for expected in (3, 3, 8, 10):
            display.draw()
            (line,) = terminal.shown
            assert f"| {expected}/10 [" in line


@pytest.mark.parametrize(
    ("stage", "line"),
    [
        ({"total": None, "unit": "files"}, "a: 0 files [00:10, ? files/s]"),
        ({"total": None, "unit": ""}, "a [00:10]"),
    ],
)
def test_a_stage_of_unknown_length_shows_no_share(terminal, stage, line):
    with terminal, shown(terminal, **stage) as display:
        display.draw()
        assert terminal.shown == [line]


def test_each_stage_has_a_bar_with_its_title(terminal, monkeypatch):
    monkeypatch.setattr(progress, "_terminal", lambda: contextlib.nullcontext(terminal))
    with terminal, progress.show_progress():
        progress.begin("a", 4, "runs")
        progress.step(2)
        progress._display.draw()
        assert terminal.shown[0].startswith("a:  50%|")
        progress.set_title("study")
        progress.begin("b")
        progress._display.draw()
        assert terminal.shown == ["study: b [00:00]"]
    assert terminal.shown == [""]


def test_a_narrow_terminal_gets_a_shorter_bar(terminal, monkeypatch):
    monkeypatch.setattr(progress.os, "get_terminal_size", lambda _: (61, 20))
    monkeypatch.setattr(Terminal, "fileno", lambda _: 0)
    with terminal, shown(terminal) as display:
        display.draw()
        (line,) = terminal.shown
    assert len(line) <= 61


def test_nothing_is_left_of_it(terminal):
    with terminal, shown(terminal) as line:
        line.draw()
    assert terminal.shown == [""]


def test_nothing_is_left_of_it_after_an_interrupt(terminal):
    def interrupted():
        with shown(terminal) as line:
            line.draw()
            raise KeyboardInterrupt

    with terminal:
        with pytest.raises(KeyboardInterrupt):
            interrupted()
        print("runner: interrupted")
    assert terminal.shown == ["runner: interrupted", ""]


def test_what_is_printed_takes_its_place_and_it_comes_back_below(terminal):
    with terminal, shown(terminal) as line:
        line.draw()
        print("runner: 8 runs", file=sys.stderr)
        print("outputs/runs/1")
        line.draw()
        first, second, third = terminal.shown
    assert (first, second) == ("runner: 8 runs", "outputs/runs/1")
    assert third.startswith("a:   0%|")
    assert terminal.shown == ["runner: 8 runs", "outputs/runs/1", ""]


def test_it_waits_for_the_end_of_a_line_that_someone_began(terminal):
    with terminal, shown(terminal) as line:
        print("a question? ", end="")
        line.draw()
        assert terminal.shown == ["a question?"]
        print("yes")
        line.draw()
        assert len(terminal.shown) == 2


def test_its_thread_draws_and_ends_with_the_work(terminal, monkeypatch):
    monkeypatch.setattr(progress, "_EVERY", 0.001)
    drawn = threading.Event()
    monkeypatch.setattr(Display, "draw", lambda _: drawn.set())
    before = threading.active_count()
    with terminal, shown(terminal):
        assert drawn.wait(PATIENCE)
    assert threading.active_count() == before


def test_a_terminal_that_is_gone_does_no_harm():
    other = Terminal()
    with shown(other) as line:
        line.draw()
        other.close()


def test_the_outputs_are_given_back_and_look_the_same_meanwhile(terminal):
    with terminal:
        with shown(terminal):
            assert sys.stdout is not terminal
            assert sys.stdout.isatty()
        assert (sys.stdout, sys.stderr) == (terminal, terminal)


def test_what_shows_its_progress_within_what_does_is_shown_once(terminal, monkeypatch):
    monkeypatch.setattr(progress, "_terminal", lambda: contextlib.nullcontext(terminal))
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


class Cell:
    """The outputs of a notebook's cell, as a kernel publishes them and an executed notebook keeps them."""

    def __init__(self):
        self.outputs, self.seen = {}, []

    def publish(self, data, transient, update):
        name = transient["display_id"]
        assert update == (name in self.outputs)  # an update of an unknown output is lost
        self.outputs[name] = data
        self.seen.append(data["text/plain"])


@pytest.fixture
def kernel(monkeypatch):
    """A Jupyter kernel, whose standard error is not a terminal."""
    shell = SimpleNamespace(config={"IPKernelApp": {}}, display_pub=Cell())
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    with contextlib.redirect_stderr(io.StringIO()):
        yield shell


def test_a_notebook_shows_it_in_one_output_that_is_empty_at_the_end(kernel, monkeypatch):
    monkeypatch.setattr(progress, "_EVERY", 3600.0)
    cell = kernel.display_pub
    with progress.show_progress():
        progress.begin("a", 4, "runs")
        for _ in range(3):
            progress.step()
            progress._display.draw()
        print("a warning", file=sys.stderr)
        progress.begin("b")
        progress._display.draw()
    shares = [text for text in cell.seen if text]
    assert [text.partition("|")[0] for text in shares] == ["a:   0%", "a:  25%", "a:  50%", "a:  75%", "b [00:00]"]
    assert list(cell.outputs.values()) == [{"text/plain": ""}]


def test_a_notebook_keeps_no_output_of_short_work(kernel):
    with progress.show_progress():
        progress.begin("a", 4, "runs")
        progress.step()
    assert kernel.display_pub.outputs == {}


def test_ipython_in_a_shell_is_not_a_notebook(kernel):
    kernel.config = {}
    with progress._terminal() as found:
        assert found is None


@pytest.mark.parametrize("size", [(0, 0), (30, 100)])
def test_a_terminal_that_does_not_tell_its_size_is_drawn_on(monkeypatch, size):
    """One that another program opened, such as a container, may say that it has no lines and no columns."""
    monkeypatch.setattr(progress, "_EVERY", 3600.0)
    reader, writer = os.openpty()
    fcntl.ioctl(writer, termios.TIOCSWINSZ, struct.pack("HHHH", *size, 0, 0))
    with os.fdopen(writer, "w") as stream, shown(stream) as line:
        line.stage.reached = 10_000
        line.draw()
        stream.flush()
        text = ""
        for _ in range(100):
            if "10.0k/20.0k" not in text:
                assert select.select([reader], [], [], PATIENCE)[0]
                text += os.read(reader, 4096).decode()
    os.close(reader)
    assert "| 10.0k/20.0k [" in text
