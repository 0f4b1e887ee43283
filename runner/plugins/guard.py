"""Runtime checks of user-supplied parts: read-only inputs, validated results, and errors with file and line.

A `Guard` contains a rule for each method and attribute of a kind of parts. It wraps a part in a proxy. The proxy passes
read-only copies to the part, and checks and copies the results. An exception in a part ends the run as a failure whose
message contains file and line. Built-in parts are not guarded.
"""

import inspect
from collections.abc import Callable
from dataclasses import FrozenInstanceError, dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, RunnerError, SimulationError, describe_part_error


class Asked(NamedTuple):
    """A method or attribute of a user-supplied part.

    Attributes:
        guard: The guard of the part.
        part: The part.
        name: Name of the method or attribute.
    """

    guard: "Guard"
    part: Any
    name: str


def fail_run(asked: Asked, fault: str) -> NoReturn:
    """End the run with a fault."""
    raise SimulationError(fault)


def refuse(asked: Asked, fault: str) -> NoReturn:
    """Reject the config of the part because of a fault."""
    raise ConfigError(f"{asked.guard.group}.kind: its {asked.name}: {fault}")


def unchecked(answer: Any, *_: object) -> Any:
    """Return a result without a check."""
    return answer


def array(*shape: int) -> Callable[..., FloatArray]:
    """Return a check that a result is an array of a shape."""
    return lambda answer, asked, *_: checked(answer, shape, asked)


def like(argument: int) -> Callable[..., FloatArray]:
    """Return a check that a result has the shape of an argument, which is given by its index."""
    return lambda answer, asked, *given: checked(answer, given[argument].shape, asked)


@dataclass(frozen=True)
class Method:
    """Rule for calls of a method, which receives read-only copies of its arguments.

    Attributes:
        check: Function of the result, an `Asked` and the arguments; returns the checked result.
        optional: True if a part does not need the method. The proxy then has the default of the base class, if any.
        owner: Function of the part; returns the object that has the method.
        fail: Function of an `Asked` and a message; handles a fault.
    """

    check: Callable[..., Any] = unchecked
    optional: bool = False
    owner: Callable[[Any], Any] = unchecked
    fail: Callable[[Asked, str], Any] = fail_run

    def bind(self, asked: Asked) -> Any:
        """Return the member of the proxy."""
        part, name, check = asked.part, asked.name, self.check

        def call(*given: Any) -> Any:
            try:
                return check(getattr(part, name)(*map(read_only, given)), asked, *given)
            except Exception as error:
                return self.handle(error, asked)

        return call

    def handle(self, error: Exception, asked: Asked) -> Any:
        """Return the result of the proxy after an error, or raise."""
        if isinstance(error, RunnerError):
            raise error
        return self.fail(asked, describe_fault(error))


class Attribute(Method):
    """Rule for reads of an attribute."""

    def bind(self, asked: Asked) -> Any:
        """Return the member of the proxy."""

        def read(_: object) -> Any:
            try:
                return self.check(getattr(asked.part, asked.name), asked)
            except Exception as error:
                return self.handle(error, asked)

        return property(read)


class Guarded:
    """Proxy of a user-supplied part with runtime checks.

    Attributes:
        part: The part.
        guard: The guard that created the proxy.
    """

    part: Any
    guard: "Guard"

    def __deepcopy__(self, _: object) -> "Guarded":
        """Return the proxy itself, because a copy of the part is not needed."""
        return self


class Guard:
    """Runtime checks of one kind of parts.

    Args:
        group: Config group of the kind.
        base: Base class of the proxy, with the defaults of optional members.
        members: Rule for each method or attribute, by name.
    """

    def __init__(self, group: str, base: type = object, /, **members: Method) -> None:
        self.group, self._base, self._members = group, base, members

    def __call__(self, part: Any, *_: object) -> Any:
        """Return the proxy of a part."""
        found = {"part": part, "guard": self}
        for name, member in self._members.items():
            owner = member.owner(part)
            if not member.optional or self._is_offered(owner, name):
                bound = member.bind(Asked(self, owner, name))
                found[name] = staticmethod(bound) if callable(bound) else bound
        return type("Guarded", (Guarded, self._base), found)()

    def _is_offered(self, owner: Any, name: str) -> bool:
        """Return True if a part defines a member itself, instead of only inheriting the default of the base class."""
        if name in getattr(owner, "__dict__", {}):
            return True
        return hasattr(owner, name) and getattr(type(owner), name, None) is not getattr(self._base, name, None)


def unguarded(part: Any) -> Any:
    """Return a part without its guard."""
    return part.part if isinstance(part, Guarded) else part


def guarded_like(part: Any, other: Any) -> Any:
    """Return `other` with the guard of `part`, if `part` has one."""
    return part.guard(other) if isinstance(part, Guarded) else other


def is_write(error: Exception) -> bool:
    """Return True if an error comes from an attempt to change a read-only value."""
    return isinstance(error, FrozenInstanceError) or (isinstance(error, ValueError) and "read-only" in str(error))


def describe_fault(error: Exception) -> str:
    """Return the message of an error in a user-supplied part, with its line and a hint about read-only values."""
    if isinstance(error, SimulationError):
        return error.reason
    hint = "; a plug-in cannot change what it is given: work on a copy" if is_write(error) else ""
    return describe_part_error(error) + hint


def checked(answer: Any, shape: tuple[int, ...], asked: Asked) -> FloatArray:
    """Return a copy of a result as an array.

    Raises:
        SimulationError: if the result has another shape or a value that is not finite; the message contains the method.
    """
    try:
        array = np.array(answer, dtype=np.float64)
        if array.shape == shape and np.isfinite(array).all():
            return array
    except (TypeError, ValueError):
        pass
    raise SimulationError(f"{place(getattr(asked.part, asked.name))} gave {find_fault(answer, shape)}")


def find_fault(answer: Any, shape: tuple[int, ...]) -> str | None:
    """Return a message about the wrong shape, type or values of an array; None if the array is correct."""
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
    """Return the name, file and line of a function."""
    code = inspect.unwrap(getattr(function, "__func__", function)).__code__
    return f"{code.co_qualname} ({Path(code.co_filename).name}, line {code.co_firstlineno})"


def read_only(value: Any) -> Any:
    """Return a read-only copy of an array or of a dataclass of arrays; return any other value unchanged.

    The original does not change even if a plug-in makes the copy writable.
    """
    if isinstance(value, np.ndarray):
        copied = value.copy()
        copied.setflags(write=False)
        return copied
    if isinstance(value, float | int) or not is_dataclass(value) or isinstance(value, type):
        return value
    return replace(value, **{field.name: read_only(getattr(value, field.name)) for field in fields(value)})
