"""Progress and remaining time of a command, displayed on a terminal or in a notebook.

A process has one `Work` object. A command calls `begin(NAME)` for each stage. It then calls `step()` as items finish,
or passes a function that returns the count. `plan` lists the coming stages with their expected
durations. `shown` displays the progress.
"""

import contextlib
import threading
from collections.abc import Iterator

from runner.base.progress.display import Display, in_words, terminal
from runner.base.progress.work import Work

__all__ = ["begin", "in_words", "named", "plan", "shown", "step"]

_work = Work()
_shown = threading.Lock()

begin, named, plan, step = _work.begin, _work.named, _work.plan, _work.step


@contextlib.contextmanager
def show_progress() -> Iterator[None]:
    """Show what is done within, from the second second on, where standard error is a terminal or a notebook's."""
    if _shown.locked():  # by who called
        yield
        return
    with _shown, terminal() as stream:
        _work.restart()
        with contextlib.nullcontext() if stream is None else Display(_work, stream):
            yield
