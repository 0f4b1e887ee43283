"""Units of config keys, and quantities with units in configs, such as 45deg, 5mm, 20ms or 1e-3 rad."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Annotated, NamedTuple, TypeVar

from runner.base.errors import nearest
from runner.base.sanitize import quoted

_DEGREE, _RPM = math.pi / 180.0, math.pi / 30.0
_ONE, _MILLI, _MICRO, _KILO = Decimal(1), Decimal("1e-3"), Decimal("1e-6"), Decimal(1000)

WRITTEN: Mapping[str, Mapping[str, Decimal | float]] = {
    "m": {"m": _ONE, "cm": Decimal("1e-2"), "mm": _MILLI, "um": _MICRO},
    "s": {"s": _ONE, "ms": _MILLI, "us": _MICRO, "ns": Decimal("1e-9"), "min": Decimal(60), "h": Decimal(3600)},
    "rad": {"rad": _ONE, "mrad": _MILLI, "deg": _DEGREE},
    "m/s": {"m/s": _ONE, "cm/s": Decimal("1e-2"), "mm/s": _MILLI},
    "m/s^2": {"m/s^2": _ONE, "mm/s^2": _MILLI},
    "rad/s": {"rad/s": _ONE, "deg/s": _DEGREE, "rpm": _RPM},
    "rad/s^2": {"rad/s^2": _ONE, "deg/s^2": _DEGREE},
    "N": {"N": _ONE, "mN": _MILLI, "kN": _KILO},
    "N s": {"N s": _ONE, "mN s": _MILLI},
    "N m": {"N m": _ONE, "mN m": _MILLI, "kN m": _KILO},
    "kg": {"kg": _ONE, "g": _MILLI},
    "kg m^2": {"kg m^2": _ONE, "kg cm^2": Decimal("1e-4"), "g m^2": _MILLI, "g cm^2": Decimal("1e-7")},
    "N/m": {"N/m": _ONE, "N/mm": _KILO, "kN/m": _KILO},
    "N m/rad": {"N m/rad": _ONE, "N m/deg": 180.0 / math.pi},
    "N s/m": {"N s/m": _ONE},
    "N m s/rad": {"N m s/rad": _ONE},
    "1/s": {"1/s": _ONE},
    "s/rad": {"s/rad": _ONE, "s/deg": 180.0 / math.pi},
    "s/m": {"s/m": _ONE},
    "Hz": {"Hz": _ONE, "kHz": _KILO},
}
"""Spellings of each unit of a key, with their factors to that unit."""

_AXES_ALONG = 3
T = TypeVar("T")


@dataclass(frozen=True)
class Unit:
    """The unit of a config key, in the annotation of its field; all attributes are empty for a key without unit.

    Attributes:
        first: Unit of the value.
        turned: Unit of the last three of six axes, if the key has one value for each axis.
        sliding: Unit for prismatic joints, if the key has joint values.
    """

    first: str = ""
    turned: str = ""
    sliding: str = ""

    def at(self, place: Sequence[str | int]) -> tuple[str, ...]:
        """Return the allowed units of a value from its path in the config: keys, and indices in lists."""
        if self.turned:
            axis = place[-1]
            return ((self.first, self.turned)[axis >= _AXES_ALONG],) if isinstance(axis, int) else ()
        return tuple(unit for unit in (self.first, self.sliding) if unit)


# Types of fields by unit, as in `duration: Seconds[PositiveFloat | None]`.
Seconds = Annotated[T, Unit("s")]
Hertz = Annotated[T, Unit("Hz")]
PerSecond = Annotated[T, Unit("1/s")]
Metres = Annotated[T, Unit("m")]
MetresPerSecond = Annotated[T, Unit("m/s")]
Acceleration = Annotated[T, Unit("m/s^2")]
Radians = Annotated[T, Unit("rad")]
RadiansPerSecond = Annotated[T, Unit("rad/s")]
Kilograms = Annotated[T, Unit("kg")]
MomentOfInertia = Annotated[T, Unit("kg m^2")]
Newtons = Annotated[T, Unit("N")]
NewtonSeconds = Annotated[T, Unit("N s")]
NewtonMetres = Annotated[T, Unit("N m")]
Stiffness = Annotated[T, Unit("N/m")]
RotaryStiffness = Annotated[T, Unit("N m/rad")]
Damping = Annotated[T, Unit("N s/m")]
# One value for each of six axes: three along them, then three about them.
AxisWrench = Annotated[T, Unit("N", turned="N m")]
AxisInertia = Annotated[T, Unit("kg", turned="kg m^2")]
AxisStiffness = Annotated[T, Unit("N/m", turned="N m/rad")]
AxisDamping = Annotated[T, Unit("N s/m", turned="N m s/rad")]
# Values of revolute and prismatic joints.
JointPosition = Annotated[T, Unit("rad", sliding="m")]
JointSpeed = Annotated[T, Unit("rad/s", sliding="m/s")]
JointSteepness = Annotated[T, Unit("s/rad", sliding="s/m")]
JointTorque = Annotated[T, Unit("N m", sliding="N")]
JointInertia = Annotated[T, Unit("kg m^2", sliding="kg")]
JointStiffness = Annotated[T, Unit("N m/rad", sliding="N/m")]
JointDamping = Annotated[T, Unit("N m s/rad", sliding="N s/m")]

_ALIKE = str.maketrans({"°": "deg", "µ": "u", "μ": "u", "²": "^2", " ": "", "*": "", "·": ""})
_BARE: Mapping[str, str] = {
    written.translate(_ALIKE): written for all_written in WRITTEN.values() for written in all_written
}
# An exponent of three digits exceeds every valid number. Longer ones would take long to evaluate.
_NUMBER = r"[-+]?(?:\d[\d_]*\.?[\d_]*|\.\d[\d_]*)(?:[eE][-+]?\d{1,3})?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})(\s*[a-zA-Z°µμ][\w°µμ ^²*·/]*|\s+1/s)")
_LONGEST = 60  # characters


class TypedQuantity(NamedTuple):
    """A number with a unit, as typed.

    Attributes:
        number: The number.
        unit: Unit after the number; a known unit has the spaces and multiplication signs of WRITTEN.
    """

    number: Decimal
    unit: str

    def in_unit(self, unit: str) -> float | None:
        """Return the number in a unit of a key; None if its unit does not convert to that unit.

        Powers of ten are exact: 20ms gives the same float as 0.02. 30deg gives the same float as math.radians(30).
        """
        factor = WRITTEN.get(unit, {}).get(self.unit)
        if factor is None:
            return None
        return float(self.number * factor) if isinstance(factor, Decimal) else float(self.number) * factor


def read_quantity(value: object) -> TypedQuantity | None:
    """Return the quantity that a string contains, with a known or unknown unit; None for any other value."""
    if not isinstance(value, str) or len(value) > _LONGEST:
        return None
    match = _QUANTITY.fullmatch(value)
    if match is None or is_number(value):
        return None
    unit = match[2].strip()
    return TypedQuantity(Decimal(match[1].replace("_", "")), _BARE.get(unit.translate(_ALIKE), unit))


def is_number(text: str) -> bool:
    """Return True for a number without unit, such as 1e3, although its end looks like a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def quantities_in(value: object) -> Iterator[str]:
    """Yield the strings in a value, list or mapping that are quantities."""
    for item in value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else [value]:
        if isinstance(item, list | dict):
            yield from quantities_in(item)
        elif isinstance(item, str) and read_quantity(item) is not None:
            yield item


def explain_quantity(text: str, units: Sequence[str]) -> str:
    """Return the error message for a quantity that a key rejects, with the allowed units.

    Args:
        text: The quantity, as typed.
        units: Allowed units of the key; empty for a key without unit.
    """
    quantity = read_quantity(text)
    unit = quantity.unit if quantity is not None else ""
    if not units:
        return f"has no unit; found {quoted(text)}; write only the number"
    if quantity is not None and any(quantity.in_unit(own) is not None for own in units):
        fits, other = ("revolute", "prismatic")[:: 1 if quantity.in_unit(units[0]) is not None else -1]
        allowed = (
            f"write {units[0]} for revolute joints, {units[-1]} for prismatic ones, a number without unit for both"
        )
        return f"{quoted(text)} has a unit of {fits} joints, and sets a {other} joint; {allowed}"
    allowed = " or ".join(f"{own} (written {', '.join(WRITTEN[own])})" for own in units)
    known = [written for all_written in WRITTEN.values() for written in all_written]
    what = "" if unit in known else f"; '{unit}' is not a unit{nearest(unit, known)}"
    return f"must be a number, or one with a unit of {allowed}; found {quoted(text)}{what}"
