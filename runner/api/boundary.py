"""Progress line, short errors and worker processes of the public functions."""

import functools
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from typing import Any, ParamSpec, TypeVar

from runner.base.errors import RunnerError
from runner.base.progress import show_progress

P = ParamSpec("P")
T = TypeVar("T")

_GO_ON = "interrupted; finished runs are stored; the same call continues"


def public(function: Callable[P, T]) -> Callable[P, T]:
    """Wrap a public function: show its progress, and raise user errors and interrupts without internal stack frames."""

    @functools.wraps(function)
    def through(*args: P.args, **kwargs: P.kwargs) -> T:
        try:
            with show_progress():
                return function(*args, **kwargs)
        except RunnerError as error:
            raise error.with_traceback(None) from None
        except KeyboardInterrupt:
            raise KeyboardInterrupt(_GO_ON) from None

    return through


def public_class(kind: type[T], stored: Any) -> T:
    """Return a stored run, sweep or tuning as the public class that inherits from its class."""
    return kind(**{each.name: getattr(stored, each.name) for each in fields(stored)})


@contextmanager
def workers_only_work() -> Iterator[None]:
    """Keep worker processes that start inside this context from running the user's program.

    By default a new process imports the file of `__main__`. A plain script, with its sweep, would then start again in
    each worker. The workers do not need that file.
    """
    main = sys.modules["__main__"].__dict__
    kept: dict[str, Any] = {name: main[name] for name in ("__file__", "__spec__") if name in main}
    main.pop("__file__", None)
    main["__spec__"] = None
    try:
        yield
    finally:
        main.update(kept)
