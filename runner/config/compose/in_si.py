"""Config quantities, such as 20ms, as plain numbers in SI units."""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from runner.base.errors import ConfigError
from runner.schema.units import Quantity, explain_quantity, read_quantity

Place = tuple[str | int, ...]

_RANGE = re.compile(r"\b(interval|range)\(([^()]*)\)")


def put_in_si(resolved: dict[str, object], config_dirs: Sequence[Path] = ()) -> None:
    """Replace each quantity whose unit fits its key by its number in SI units.

    What fits no key stays, and the checks of the config tell of it beside all other problems.

    Args:
        resolved: The config as plain data, interpolations resolved; it is changed.
        config_dirs: Config folders of the user's, in which URDFs are looked for: a joint that slides takes lengths.
    """
    read = ((place, text, read_quantity(text)) for place, text in leaves(resolved) if isinstance(text, str))
    found = [(place, text, quantity) for place, text, quantity in read if quantity is not None]
    if not found:
        return
    from runner.config.compose.key_units import units_at  # the models of all kinds, which few configs need here

    of_joints: list[tuple[Place, str, str]] = []
    for place, text, quantity in found:
        units = units_at(resolved, place)
        for unit in units.at(place):
            value = quantity.in_unit(unit)
            if value is not None:
                set_value(resolved, place, value)
                if units.sliding:
                    of_joints.append((place, text, "m" if unit == units.sliding else "rad"))
    for place, text in _wrong_joints(resolved, of_joints, config_dirs) if of_joints else ():
        set_value(resolved, place, text)


def leaves(value: object, place: Place = ()) -> Iterator[tuple[Place, object]]:
    """Yield the place and value of all that a config holds, in its groups and lists."""
    inner = value.items() if isinstance(value, Mapping) else enumerate(value) if isinstance(value, list) else None
    if inner is None:
        yield place, value
    else:
        for key, item in inner:
            yield from leaves(item, (*place, key))


def set_value(config: Any, place: Place, value: object) -> None:
    """Put a value at a place of a config."""
    for key in place[:-1]:
        config = config[key]
    config[place[-1]] = value


def _wrong_joints(
    resolved: dict[str, object], given: Sequence[tuple[Place, str, str]], config_dirs: Sequence[Path]
) -> Iterator[tuple[Place, str]]:
    """Yield place and text of quantities that are angles where a joint slides, or lengths where one turns."""
    from runner.config.arms import build_robot
    from runner.config.parsing import group_of, parse_robot
    from runner.robots.model import STANDARD_GRAVITY

    try:
        arm = build_robot(parse_robot(group_of("robot", resolved)), STANDARD_GRAVITY, config_dirs)
    except ConfigError:
        return  # the checks of the robot tell
    for place, text, unit in given:
        stages = [stage for stage in arm.stages if stage.name in place] or arm.stages
        names = [name for stage in stages for name in stage.model.joint_names]
        units = [unit for stage in stages for unit in stage.model.joint_units]
        last = place[-1]
        if isinstance(last, int):
            units = units[last : last + 1]
        elif last in names:
            units = [units[names.index(last)]]
        if set(units) - {unit}:
            yield place, text


def as_numbers(values: Sequence[object], key: str) -> list[float] | None:
    """Return the values of a swept key, some of them quantities and the others numbers, in SI units.

    Args:
        values: The values.
        key: The dotted key.

    Returns:
        The numbers; None where none is a quantity, or one is no number in a unit of the key. All quantities have the
        same one, as a joint that turns takes none of a joint that slides.
    """
    read: list[tuple[Any, Quantity | None]] = []
    for value in values:
        quantity = read_quantity(value)
        if quantity is None and not isinstance(value, int | float):
            return None
        read.append((value, quantity))
    if not any(quantity for _, quantity in read):
        return None
    for unit in units_of(key):
        found: list[Any] = [value if quantity is None else quantity.in_unit(unit) for value, quantity in read]
        if None not in found:
            return found
    return None


def with_numbers(override: str) -> str:
    """Return an override in which the quantities of ranges, as in interval(5ms,50ms), are numbers in SI units.

    Raises:
        ConfigError: for one whose unit does not fit the key.
    """
    key, _, value = override.partition("=")

    def number(text: str) -> str:
        name, equals, given = text.rpartition("=")
        quantity = read_quantity(given)
        if quantity is None:
            return text
        units = units_of(key.lstrip("+~"))
        found = next((found for unit in units if (found := quantity.in_unit(unit)) is not None), None)
        if found is None:
            raise ConfigError([f"{key.lstrip('+~')}: {explain_quantity(given, units)}"])
        return f"{name}{equals}{found!r}"

    def numbers(match: re.Match[str]) -> str:
        return f"{match[1]}({','.join(map(number, match[2].split(',')))})"

    return f"{key}={_RANGE.sub(numbers, value)}" if "(" in value else override


def units_of(key: str) -> Sequence[str]:
    """Return the units in which a dotted key may count, whatever is chosen in its group."""
    from runner.config.compose.key_units import units_of_key  # the models of all kinds, which few command lines need

    return units_of_key(key).at(key.split("."))
