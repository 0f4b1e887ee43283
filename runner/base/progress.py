"""Progress of a command: a tqdm bar for the current stage, on a terminal or in a notebook.

A command calls `begin(NAME)` for each stage. It then calls `step()` as items finish, or passes a function that returns
the count. `show_progress` draws the bar; without it these functions do nothing.
"""

import contextlib
import io
import os
import sys
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Self, TextIO

_EVERY = 1.0  # s between two updates of the bar, and before the first one
_COLUMNS, _LINES = 80, 24  # of a terminal that reports no size


@dataclass
class _Stage:
    """Current stage with its name and progress; `began` is a time in s."""

    name: str
    total: float | None = None
    unit: str = ""
    count: Callable[[], float] | None = None
    began: float = field(default_factory=time.time)
    reached: float = 0.0


class _Display:
    """Bar at the bottom of a terminal, updated by a thread each second; it is removed at the end.

    A print through `sys.stdout` or `sys.stderr` removes the bar, which comes back below the printed line. C libraries
    print to descriptor 2, which runner/base/engine_output.py redirects. The stream should therefore be a copy of it.
    """

    def __init__(self, stream: TextIO) -> None:
        self.stage, self.title = _Stage("starting"), ""
        self._stream = stream
        self._bar: Any = None
        self._drawn_stage: _Stage | None = None
        self._line_open = False  # the last print did not end its line
        self._lock = threading.RLock()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._update, daemon=True, name="progress")

    def draw(self) -> None:
        """Draw the bar of the current stage."""
        with self._lock:
            stage = self.stage
            if self._line_open:
                return
            if self._drawn_stage is not stage:
                self._close()
                name = f"{self.title}: {stage.name}" if self.title else stage.name
                self._bar, self._drawn_stage = _bar(self._stream, stage, name), stage
            done = stage.reached if stage.count is None else stage.count()
            self._bar.n = max(self._bar.n, done if stage.total is None else min(done, stage.total))
            self._bar.refresh()

    @contextlib.contextmanager
    def printing(self, text: str) -> Iterator[None]:
        """Remove the bar during a print."""
        with self._lock:
            if self._bar is not None:
                self._bar.clear()
            yield
            if text:
                self._line_open = not text.endswith("\n")

    def _update(self) -> None:
        while not self._ended.wait(_EVERY):
            try:
                self.draw()
            except (OSError, ValueError):  # the terminal is closed
                return

    def _close(self) -> None:
        if self._bar is not None:
            with contextlib.suppress(OSError, ValueError):
                self._bar.close()

    def __enter__(self) -> Self:
        self._outputs = sys.stdout, sys.stderr
        sys.stdout, sys.stderr = (_Output(stream, self) for stream in self._outputs)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        sys.stdout, sys.stderr = self._outputs
        self._close()


class _NotebookLine(io.StringIO):
    """A line of a cell's outputs that is replaced in place, so that an executed notebook keeps no progress."""

    encoding = "utf-8"

    def __init__(self, publisher: Any) -> None:
        super().__init__()
        self._publisher, self._name = publisher, f"progress-{uuid.uuid4()}"
        self._shown: str | None = None  # before the first text

    def write(self, text: str) -> int:
        line = text.strip()
        if text and line != (self._shown or ""):
            data, transient = {"text/plain": line}, {"display_id": self._name}
            self._publisher.publish(data, transient=transient, update=self._shown is not None)
            self._shown = line
        return len(text)


class _Output:
    """An output of the process that removes the bar before each print."""

    def __init__(self, stream: TextIO, display: _Display) -> None:
        self._stream, self._display = stream, display

    def write(self, text: str) -> int:
        with self._display.printing(text):
            return self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


_display: _Display | None = None  # within show_progress


def begin(name: str, total: float | None = None, unit: str = "", count: Callable[[], float] | None = None) -> None:
    """Begin the next stage.

    Args:
        name: Name of the stage.
        total: Total amount; None if unknown.
        unit: Unit of the amount.
        count: Function that returns the completed amount from any thread, if `step` is not called.
    """
    if _display is not None:
        _display.stage = _Stage(name, total, unit, count)


def step(done: float = 1.0) -> None:
    """Add to the completed amount of the stage, in its unit."""
    if _display is not None:
        _display.stage.reached += done


def set_title(title: str) -> None:
    """Print a title before the names of the following stages."""
    if _display is not None:
        _display.title = title


@contextlib.contextmanager
def show_progress() -> Iterator[None]:
    """Show the stages begun within, after the first second, if standard error is a terminal or a notebook."""
    global _display
    if _display is not None:  # the caller shows the progress
        yield
        return
    with _terminal() as stream, contextlib.nullcontext() if stream is None else _Display(stream) as _display:
        try:
            yield
        finally:
            _display = None


@contextlib.contextmanager
def _terminal() -> Iterator[TextIO | None]:
    """Yield a copy of standard error if it is a terminal; a line of the cell in a notebook; None otherwise."""
    copy = None
    with contextlib.suppress(OSError, ValueError):  # it is closed, or not a file
        if sys.stderr.isatty():
            copy = os.dup(sys.stderr.fileno())
    if copy is None:
        shell = _find_kernel()
        yield None if shell is None else _NotebookLine(shell.display_pub)
        return
    with os.fdopen(copy, "w", encoding=sys.stderr.encoding, errors="replace") as stream:
        yield stream


def _find_kernel() -> Any:
    """Return IPython's shell in a Jupyter kernel; None elsewhere."""
    known: Any = sys.modules.get("IPython")
    shell = known.get_ipython() if known is not None else None
    return shell if shell is not None and "IPKernelApp" in shell.config else None


def _bar(stream: TextIO, stage: _Stage, name: str) -> Any:
    """Return the bar of a stage, with elapsed and remaining time; a stage without a unit has elapsed time only."""
    from tqdm import tqdm  # in the thread that draws; a short command does not need it

    class Bar(tqdm):  # type: ignore[type-arg]
        monitor_interval = 0  # no second thread

    size: dict[str, Any] = {"dynamic_ncols": True} if _has_size(stream) else {"ncols": _COLUMNS, "nrows": _LINES}
    shape = {} if stage.unit else {"bar_format": "{desc} [{elapsed}]"}
    unit, large = f" {stage.unit}", (stage.total or 0) >= 1e4
    options = {"desc": name, "total": stage.total, "unit": unit, "unit_scale": large, "leave": False, **shape, **size}
    bar = Bar(file=stream, disable=False, **options)
    bar.start_t = stage.began
    return bar


def _has_size(stream: TextIO) -> bool:
    """Return True if a terminal reports its size; a pseudo-terminal of another program can have no columns or lines."""
    try:
        return min(os.get_terminal_size(stream.fileno())) > 0
    except (OSError, ValueError):  # not a file
        return True
