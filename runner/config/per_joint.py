"""A value for every joint, or one for each."""

import math
from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import BeforeValidator

from runner.errors import ConfigError


def _check(value: Any) -> Any:  # noqa: ANN401 - whatever a YAML file may hold
    numbers = value if isinstance(value, list) else [value]
    for number in numbers:
        is_number = isinstance(number, int | float) and not isinstance(number, bool)
        if not is_number or not 0.0 < number < math.inf:
            raise ValueError("must be a number above 0, or a list of such numbers with one for each joint")
    return [float(number) for number in numbers] if isinstance(value, list) else float(value)


PositivePerJoint = Annotated[float | list[float], BeforeValidator(_check)]


def expand(key: str, value: float | list[float], joints: Sequence[str]) -> list[float]:
    """Return one value for each joint.

    Raises:
        ConfigError: if a list has another length than the arm has joints; names the joints.
    """
    if not isinstance(value, list):
        return [value] * len(joints)
    if len(value) != len(joints):
        raise ConfigError([f"{key}: {len(value)} values for {len(joints)} joints ({', '.join(joints)}); found {value}"])
    return value
