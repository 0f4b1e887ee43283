"""Units of config keys, and quantities such as 20ms as plain numbers in SI units."""

import contextlib
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

from runner.base.dotted_keys import Place, leaves, put, split_override
from runner.base.errors import ConfigError
from runner.schema.model import LARGEST_WHOLE, StrictModel
from runner.schema.units import Unit, explain_quantity, read_quantity

_FUNCTION = re.compile(r"\b(interval|range|choice|sort|shuffle)\(([^()]*)\)")


def to_si(resolved: dict[str, object], config_dirs: Sequence[Path] = ()) -> None:
    """Replace each quantity whose unit fits its key by its number in SI units, and integers of a float key by floats.

    The values 1 and 1.0 of a float key are then one value, in one run. Quantities that do not fit their key remain:
    validation reports them with all other problems.

    Args:
        resolved: The config as plain data, interpolations resolved; the function changes it.
        config_dirs: Config folders of the user. They may contain the robot's file, which defines prismatic joints.
    """
    of_joints: list[tuple[Place, str, bool]] = []
    for place, text in leaves(resolved):
        if type(text) is int and abs(text) <= LARGEST_WHOLE and _is_float(resolved, place):
            put(resolved, place, float(text))
        quantity = read_quantity(text)
        if quantity is None:
            continue
        unit = unit_at(resolved, place)
        for each in unit.at(place):
            value = quantity.in_unit(each)
            if value is not None:
                put(resolved, place, value)
                if unit.sliding:
                    of_joints.append((place, str(text), each == unit.sliding))
    joints = _sliding_joints(resolved, config_dirs) if of_joints else {}
    for place, text, prismatic in of_joints:
        if _of_place(place, joints) - {prismatic}:
            put(resolved, place, text)


def _sliding_joints(resolved: Mapping[str, object], config_dirs: Sequence[Path]) -> Mapping[str, Mapping[str, bool]]:
    """Return by stage and joint True for a prismatic joint; empty for a robot whose files cannot be read."""
    from runner.config.parsing import group_of, parse_robot
    from runner.config.robot_files import sliding_joints

    try:
        return sliding_joints(parse_robot(group_of("robot", resolved)), config_dirs)
    except ConfigError:
        return {}  # validation reports it


def _of_place(place: Place, joints: Mapping[str, Mapping[str, bool]]) -> set[bool]:
    """Return the joint types at a path in a config, True for prismatic; empty if the joints are unknown."""
    stages = [joints[key] for key in map(str, place) if key in joints] or joints.values()
    named = [joint for stage in stages for joint in stage.items()]
    last = place[-1]
    own = (
        named[last : last + 1] if isinstance(last, int) else [joint for joint in named if joint[0] == last][:1] or named
    )
    return {prismatic for _, prismatic in own}


def key_unit(key: str) -> str:
    """Return the unit of a dotted key, such as "rad/s" for "controller.natural_frequency".

    The unit is "1" for a key without unit, an unknown key, and a key whose unit differs between kinds of its group.
    """
    return _find_unit(key.split(".")).first or "1"


def unit_at(resolved: Mapping[str, Any], place: Sequence[str | int]) -> Unit:
    """Return the unit at a path in a config (keys, and indices in lists), for the kinds that the config chooses."""
    options = resolved.get(str(place[0]))
    return _find_unit(place, options.get("kind") if len(place) > 1 and isinstance(options, Mapping) else None)


def _find_unit(place: Sequence[str | int], kind: str | None = None) -> Unit:
    """Return the unit at a path for a kind of its group, or for all kinds; an empty one if it differs between them."""
    group, *rest = [str(part) for part in place]
    found = {model.find_unit(rest or [group]) for model in _models(group if rest else "", rest, kind)} - {None}
    return found.pop() or Unit() if len(found) == 1 else Unit()


def _is_float(resolved: Mapping[str, Any], place: Place) -> bool:
    """Return True if the number at a path in a config is a float, for the kind that the config chooses."""
    group, *rest = [str(part) for part in place]
    options = resolved.get(group)
    kind = options.get("kind") if rest and isinstance(options, Mapping) else None
    chosen = kind if isinstance(kind, str) else None  # validation rejects any other
    found = [model.find_field(rest or [group]) for model in _models(group if rest else "", rest, chosen)]
    types: list[Any] = [field.annotation for field in found if field is not None]
    return bool(types) and all(map(_holds_floats, types))


@lru_cache(maxsize=1024)
def _holds_floats(annotation: object) -> bool:
    """Return True if the numbers in a field of a model are floats, not integers."""
    types = set(_types(annotation))
    return float in types and int not in types


def _types(annotation: object) -> Iterator[object]:
    """Yield the types in an annotation, such as float in `list[PositiveFloat] | None`."""
    inner = get_args(annotation)
    if not inner:
        yield annotation
    for part in inner[:1] if get_origin(annotation) is Annotated else inner:
        yield from _types(part)


def as_numbers(values: Sequence[object], key: str) -> list[float] | None:
    """Return the values of a swept key, some of them quantities and the others numbers, in SI units.

    Args:
        values: The values.
        key: The dotted key.

    Returns:
        The numbers; None if there is no quantity, or if a value has no number in a unit of the key. All quantities have
        the same unit, because a joint is either revolute or prismatic.
    """
    read = [(value, read_quantity(value)) for value in values]
    if not any(quantity for _, quantity in read):
        return None
    if not all(quantity or isinstance(value, int | float) for value, quantity in read):
        return None
    for unit in _find_unit(key.split(".")).at(key.split(".")):
        found: list[Any] = [value if quantity is None else quantity.in_unit(unit) for value, quantity in read]
        if None not in found:
            return found
    return None


def with_numbers(override: str) -> str:
    """Return an override in which the quantities of functions, as in interval(5ms,50ms), are numbers in SI units.

    Raises:
        ConfigError: for a quantity whose unit does not fit the key.
    """
    key, value = split_override(override)
    place = key.split(".")

    def number(text: str, of_numbers: bool) -> str:
        name, equals, given = text.rpartition("=")
        quantity, units = read_quantity(given), _find_unit(place).at(place)
        if quantity is None or not (units or of_numbers):
            return text
        found = next((found for unit in units if (found := quantity.in_unit(unit)) is not None), None)
        if found is None:
            raise ConfigError(f"{key}: {explain_quantity(given, units)}")
        return f"{name}{equals}{found!r}"

    def numbers(match: re.Match[str]) -> str:
        of_numbers = match[1] in ("interval", "range")  # the others may have names, such as 3m
        return f"{match[1]}({','.join(number(text, of_numbers) for text in match[2].split(','))})"

    return f"{override.removesuffix(value)}{_FUNCTION.sub(numbers, value)}" if "(" in value else override


def _models(group: str, rest: Sequence[str], chosen: str | None = None) -> Iterator[type[StrictModel]]:
    """Yield the models of a group, or only that of the chosen kind."""
    from runner.config.groups import GROUPS
    from runner.config.robot import OneArmConfig, StageConfig
    from runner.config.settings import RunSettings
    from runner.plugins.registry import Kinds

    known = GROUPS.get(group)
    if group == "calibration":
        from runner.calibration import CALIBRATIONS  # for few commands

        known = CALIBRATIONS
    if not group:
        yield RunSettings
    elif rest[0] == "stages":
        yield from (StageConfig, OneArmConfig)
    elif isinstance(known, Kinds):
        for kind in known.names() if chosen is None else [chosen]:
            with contextlib.suppress(ConfigError):  # a user-supplied part that cannot be imported
                yield known.config_model(kind)
    elif known is not None:
        yield known
