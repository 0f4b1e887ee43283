"""Fixed structure and variable parameters of compiled control laws and arms."""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.robots.drawn import by_run
from runner.robots.model import RobotModel
from runner.symbolic.arm import Folding, constant_of, constants_of, to_scalar, to_scalars
from runner.symbolic.vectors import Scalar


class CannotCompileError(RunnerError):
    """A law has no compiled form; the message contains the reason."""


Visit = Callable[[Callable[[Any], Any]], object]
"""A function that calls another for each number of a program, in the order of the program's parameters."""


def values_of(visit: Visit, constants: Sequence[float | None] | None = None) -> FloatArray:
    """Return the values of a program's parameters, shape (k,); shape (runs, k) if some are arrays over runs.

    Args:
        visit: Visit of the numbers.
        constants: Constants of the program, if it was made for other numbers; see constants_in.
    """
    values: list[Any] = []

    def number(value: Any) -> Any:
        values.append(value)
        return value

    if constants is None:
        visit(number)
    else:
        known = iter(constants)
        visit(Folding(number, lambda value: number(value) if (own := next(known)) is None else own))
    return by_run(values) if any(isinstance(value, np.ndarray) for value in values) else np.array(values, dtype=float)


def constants_in(visit: Visit) -> list[float | None]:
    """Return the constants of a program: 0, 1 or -1 for each number that may be one; None for a parameter."""
    found: list[float | None] = []

    def fold(value: Any) -> Any:
        found.append(constant_of(value))
        return value

    visit(Folding(lambda value: value, fold))
    return found


def scalars(numbers: Any, number: Callable[[float], Scalar]) -> Any:
    """Return a law's numbers as nested scalars: 0, 1 and -1 as floats, others converted by `number`."""
    if isinstance(numbers, tuple):
        inner = [scalars(value, number) for value in numbers]
        return type(numbers)(*inner) if hasattr(numbers, "_fields") else tuple(inner)
    if isinstance(numbers, np.ndarray):
        found = np.empty(numbers.shape, dtype=object)
        for place in np.ndindex(numbers.shape):
            found[place] = to_scalar(numbers[place], number)
        return found
    return to_scalars(numbers, number)


@lru_cache(maxsize=256)
def arm_pattern(model: RobotModel) -> str:
    """Return a string that is the same for two arms with the same structure and the same constants 0, 1 and -1."""
    return repr(constants_of(model, any_number))


def any_number(_: float) -> str:
    """Return the symbol for a number with unknown value."""
    return "x"


def plain_structure(name: str, value: Any) -> Any:
    """Return a fixed value of the code as plain data, without its attribute `parameters`.

    Args:
        name: Name of the value, for the message.
        value: The value.

    Raises:
        CannotCompileError: if the value cannot be compared.
    """
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.ndarray) and value.dtype != object:
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, (tuple, list)):
        return [plain_structure(name, entry) for entry in value]
    if isinstance(value, Mapping):
        return {str(key): plain_structure(str(key), entry) for key, entry in value.items()}
    if callable(value) or not hasattr(value, "__dict__"):
        raise CannotCompileError(f"a law that keeps {name}, {type(value).__name__}, whose use is not known")
    kind = type(value)
    kept = {key: entry for key, entry in vars(value).items() if key != "parameters"}
    return f"{kind.__module__}.{kind.__qualname__}", plain_structure(name, kept)
