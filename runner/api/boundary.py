"""Progress line and short errors of the public functions."""

import functools
from collections.abc import Callable
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
