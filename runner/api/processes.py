"""Worker processes that do not run the user's main program."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def workers_only_work() -> Iterator[None]:
    """Keep processes that are started within from running the user's program, as Python else lets each of them do.

    A new process imports what `__main__` came from; a plain script would begin again there, and its sweep with it. Our
    workers need nothing of it.
    """
    main = sys.modules["__main__"].__dict__
    kept: dict[str, Any] = {name: main[name] for name in ("__file__", "__spec__") if name in main}
    main.pop("__file__", None)
    main["__spec__"] = None
    try:
        yield
    finally:
        main.update(kept)
