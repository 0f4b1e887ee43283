"""What the tests of findings share: the values behind one, changed one at a time."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from runner.reporting.findings import Finding
from runner.reporting.measured import Measured

Arguments = tuple[Any, ...]
_CHANGES: tuple[Callable[[float], float], ...] = (
    lambda value: 1000.0 * value,
    lambda value: value / 1000.0,
    lambda value: value + 1000.0,  # what is of the size of rounding, or none, becomes large by this alone
)


def m(value: float | None, unit: str = "m", name: str = "some value") -> Measured:
    """Return a measured value; its name is of no matter where one at a time is looked at."""
    return Measured(name, value, unit)


def spoiled(arguments: Arguments, change: Callable[[float], float | None]) -> Iterator[Arguments]:
    """Yield the arguments with each measured value in them changed in turn, however deep it stands."""
    for index, argument in enumerate(arguments):
        for other in _changed(argument, change):
            yield (*arguments[:index], other, *arguments[index + 1 :])


def _changed(argument: object, change: Callable[[float], float | None]) -> Iterator[object]:
    if isinstance(argument, Measured):
        assert argument.value is not None
        yield Measured(argument.name, change(argument.value), argument.unit)
    elif isinstance(argument, Sequence) and not isinstance(argument, str):
        yield from (type(argument)(each) for each in spoiled(tuple(argument), change))  # type: ignore[call-arg]


def never_failing(conclude: Callable[..., Finding], arguments: Arguments) -> list[str]:
    """Return the conditions that do not fail whichever value is changed, by a factor of a thousand or by a thousand."""
    found = conclude(*arguments)
    fell = {
        index
        for change in _CHANGES
        for other in spoiled(arguments, change)
        for index, condition in enumerate(conclude(*other).conditions)
        if not condition.holds
    }
    return [condition.text for index, condition in enumerate(found.conditions) if index not in fell]


def texts_without_a_value(conclude: Callable[..., Finding], arguments: Arguments) -> Iterator[Finding]:
    """Yield the finding as it is with each of its values missing in turn."""
    return (conclude(*other) for other in spoiled(arguments, lambda _: None))
