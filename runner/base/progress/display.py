"""Progress line at the bottom of a terminal."""

import contextlib
import os
import sys
import threading
from collections.abc import Iterator
from typing import Any, Self, TextIO

from runner.base.progress.work import Work

_LONGEST = 20  # characters of the bar
_WIDE, _HIGH = 80, 24  # characters and lines of a terminal that does not tell
_EVERY = 1.0  # s between two looks at the work, and before the first one


class Display:
    """Draws the work anew each second, from a thread of its own, until it ends; nothing is left of the line then.

    What is printed meanwhile through `sys.stdout` and `sys.stderr` takes the line's place, and the line comes back
    below it. What C libraries print is caught elsewhere (runner/base/engine_output.py) by turning descriptor 2 aside,
    so the stream should be a copy of it.

    Args:
        work: The work.
        stream: The terminal.
    """

    def __init__(self, work: Work, stream: TextIO) -> None:
        self._work, self._stream = work, stream
        self._bar: Any = None
        self._drawn = False
        self._begun_line = False  # by someone else, who has not ended it
        self._drawing = threading.RLock()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._go_on, daemon=True, name="progress")

    def draw(self) -> None:
        """Draw the line as the work is now."""
        with self._drawing:
            if self._begun_line:
                return
            if self._bar is None:
                self._bar = _bar(self._stream)
            share, left = self._work.share, self._work.left
            done = f"{100.0 * share:.0f} %, " if share is not None else ""
            rest = f", about {in_words(left)} left" if left is not None else ""
            said, after = self._work.said, f"{done}{_clock(self._work.elapsed)}{rest}"
            room = (self._bar.format_dict["ncols"] or _WIDE) - len(f"{said} || {after}") - 1
            self._bar.n = share or 0.0
            self._bar.bar_format = f"{_escaped(said)} |{{bar:{max(1, min(_LONGEST, room))}}}| {after}"
            self._bar.refresh()
            self._drawn = True

    @contextlib.contextmanager
    def aside(self, text: str) -> Iterator[None]:
        """Take the line away while someone prints a text."""
        with self._drawing:
            if self._drawn:
                self._bar.clear()
                self._drawn = False
            yield
            if text:
                self._begun_line = not text.endswith("\n")

    def _go_on(self) -> None:
        while not self._ended.wait(_EVERY):
            try:
                self.draw()
            except (OSError, ValueError):  # the terminal is gone
                return

    def __enter__(self) -> Self:
        self._outputs = sys.stdout, sys.stderr
        sys.stdout, sys.stderr = (_Printed(stream, self) for stream in self._outputs)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        sys.stdout, sys.stderr = self._outputs
        if self._bar is not None:
            with contextlib.suppress(OSError, ValueError):
                self._bar.close()


class _Printed:
    """An output of the process whose texts take the place of the line."""

    def __init__(self, stream: TextIO, display: Display) -> None:
        self._stream, self._display = stream, display

    def write(self, text: str) -> int:
        with self._display.aside(text):
            return self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@contextlib.contextmanager
def terminal() -> Iterator[TextIO | None]:
    """Yield a copy of standard error to draw on, where it is a terminal; in a notebook itself; None otherwise."""
    copy = None
    with contextlib.suppress(OSError, ValueError):  # it is closed, or no file
        if sys.stderr.isatty():
            copy = os.dup(sys.stderr.fileno())
    if copy is None:
        yield sys.stderr if _in_notebook() else None
        return
    with os.fdopen(copy, "w", encoding=sys.stderr.encoding, errors="replace") as stream:
        yield stream


def _in_notebook() -> bool:
    """Tell whether a Jupyter kernel shows what is printed; it takes a carriage return as a terminal does."""
    known: Any = sys.modules.get("IPython")
    shell = known.get_ipython() if known is not None else None
    return shell is not None and "IPKernelApp" in shell.config


def _bar(stream: TextIO) -> Any:
    from tqdm import tqdm  # by the thread that draws, so that a short command does without

    class Bar(tqdm):  # type: ignore[type-arg]
        monitor_interval = 0  # no second thread

    shape: dict[str, Any] = {"dynamic_ncols": True} if _has_size(stream) else {"ncols": _WIDE, "nrows": _HIGH}
    return Bar(total=1.0, file=stream, leave=False, disable=False, bar_format="{bar}", **shape)


def _has_size(stream: TextIO) -> bool:
    """Tell whether a terminal knows how large it is; one that another program opened may have no columns or lines."""
    try:
        return min(os.get_terminal_size(stream.fileno())) > 0
    except (OSError, ValueError):  # no file
        return True


def _clock(seconds: float) -> str:
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def in_words(seconds: float) -> str:
    """Return a duration as a person would say it."""
    if seconds < 90.0:
        return f"{max(1, round(seconds))} s"
    if seconds < 5400.0:
        return f"{round(seconds / 60.0)} min"
    return f"{seconds / 3600.0:.1f} h"


def _escaped(text: str) -> str:
    return text.replace("{", "{{").replace("}", "}}")
