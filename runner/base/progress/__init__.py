"""What a command is at, and for how long still: told by whoever does the work, shown on a terminal.

There is one work in a process. Who does it says `begin(NAME)` of each stage, and `step()` of what is made, or gives a
count that can be asked; `plan` says what is to come and what it costs. Whether any of it is seen is the matter of
`shown`.
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
