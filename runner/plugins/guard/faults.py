"""Fault messages for results and exceptions of plug-ins, with their source location."""

import inspect
from collections.abc import Callable
from dataclasses import FrozenInstanceError
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.errors import RunnerError, SimulationError, describe_part_error


def is_write(error: Exception) -> bool:
    """Tell whether an error is that of writing to what cannot be written to."""
    return isinstance(error, FrozenInstanceError) or (isinstance(error, ValueError) and "read-only" in str(error))


def told_of_part(error: Exception) -> str:
    """Return what an error of the user's part says, with its place and, where it tried to write, what to do."""
    hint = "; a plug-in cannot change what it is given: work on a copy" if is_write(error) else ""
    return describe_part_error(error) + hint


def ask(part: Callable[..., Any], time: float, *handed: Any) -> Any:
    """Return what a function of the user's answers.

    Args:
        part: The function.
        time: When it is asked, in s since the start.
        handed: Its arguments.

    Raises:
        SimulationError: where it raises; names the place.
    """
    try:
        return part(*handed)
    except (RunnerError, SimulationError):
        raise
    except Exception as error:
        raise SimulationError(told_of_part(error), time) from error


def checked(answer: Any, shape: tuple[int, ...], part: Callable[..., Any], time: float) -> NDArray[np.float64]:
    """Return a copy of an answer as an array.

    Args:
        answer: What a function of the user's gave.
        shape: The shape that it must have.
        part: The function.
        time: When it was asked, in s since the start.

    Raises:
        SimulationError: for another shape, or values that are not finite; names the function.
    """
    fault = find_fault(answer, shape)
    if fault:
        raise SimulationError(f"{place(part)} gave {fault}", time)
    return np.array(answer, dtype=np.float64)


def find_fault(answer: Any, shape: tuple[int, ...]) -> str | None:
    """Return what is wrong with an array, in words; None where nothing is."""
    wanted = f"it must be an array of shape {shape}" if shape else "it must be a number"
    try:
        array = np.asarray(answer, dtype=np.float64)
    except (TypeError, ValueError):
        return f"{answer!r}; {wanted}"
    if array.shape != shape:
        return f"{f'an array of shape {array.shape}' if array.ndim else repr(answer)}; {wanted}"
    if not np.isfinite(array).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        return f"{array[index]}{f' at index {list(index)}' if shape else ''}; it must be finite"
    return None


def place(function: Callable[..., Any]) -> str:
    """Return where a function of the user's stands."""
    code = inspect.unwrap(getattr(function, "__func__", function)).__code__
    return f"{code.co_qualname} ({Path(code.co_filename).name}, line {code.co_firstlineno})"
