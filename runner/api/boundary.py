"""Progress line and short errors of the public functions."""

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from runner.base.errors import RunnerError
from runner.base.progress import show_progress

P = ParamSpec("P")
T = TypeVar("T")

_GO_ON = "interrupted; finished runs are stored; the same call continues"


def door(function: Callable[P, T]) -> Callable[P, T]:
    """Show how far a function is; let what a user can mend, and interruptions, out of it without the frames within."""

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
