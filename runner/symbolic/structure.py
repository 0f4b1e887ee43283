"""Fixed structure and variable parameters of compiled control laws and arms."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from runner.base.errors import RunnerError
from runner.robots.model import RobotModel
from runner.symbolic.arm import constants_of, to_scalars
from runner.symbolic.vectors import Scalar, as_array


class CannotCompileError(RunnerError):
    """A law has no compiled form; the message contains the reason."""


class Values:
    """Values of a program's parameters, in the order of the calls of `number`."""

    def __init__(self) -> None:
        self.values: list[float] = []

    def number(self, value: float) -> float:
        """Append a value, and return it."""
        self.values.append(value)
        return value


def scalars(numbers: Any, number: Callable[[float], Scalar]) -> Any:
    """Return a law's numbers as nested scalars: 0, 1 and -1 as floats, others converted by `number`."""
    if isinstance(numbers, tuple):
        inner = [scalars(value, number) for value in numbers]
        return type(numbers)(*inner) if hasattr(numbers, "_fields") else tuple(inner)
    if isinstance(numbers, np.ndarray):
        flat = [to_scalars(value, number) for value in numbers.ravel()]
        return as_array(flat).reshape(numbers.shape)
    return to_scalars(numbers, number)


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
        raise CannotCompileError(f"a law that keeps {name}, {type(value).__name__}, of which nobody knows what it does")
    kind = type(value)
    kept = {key: entry for key, entry in vars(value).items() if key != "parameters"}
    return f"{kind.__module__}.{kind.__qualname__}", plain_structure(name, kept)
