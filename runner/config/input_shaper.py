"""Config of the input shaper."""

import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from runner.schema.model import StrictModel
from runner.schema.units import Hertz

MODE = re.compile(r"mode_([1-9]\d?)")
"""Name of a mode of the plant."""

_MOST = 4  # modes of one shaper: three impulses each


def _frequency(value: Any) -> Any:
    wanted = value if isinstance(value, list) else [value]
    number = [isinstance(each, int | float) and not isinstance(each, bool) and each > 0.0 for each in wanted]
    named = [isinstance(each, str) and MODE.fullmatch(each) is not None for each in wanted]
    if not 1 <= len(wanted) <= _MOST or not all(map(max, number, named)):
        raise ValueError(f"must be a number above 0, the name of a mode such as mode_1, or a list of up to {_MOST}")
    return value


class InputShaperConfig(StrictModel):
    """Config of an input shaper, after Singer and Seering (J. Dyn. Syst. Meas. Control 112, 1990).

    Attributes:
        kind: zv, two impulses half a period apart; zvd, three in one period.
        frequency: Undamped frequency of the mode to suppress, in Hz. Or mode_1, mode_2, ... of the flexible plant in
            the start configuration with locked motors. Or a list of these.
        damping_ratio: Damping ratio of these modes. None takes that of the plant, and 0 for a frequency in Hz.
    """

    kind: Literal["zv", "zvd"]
    frequency: Hertz[Annotated[float | str | list[float | str], BeforeValidator(_frequency)]]
    damping_ratio: Hertz[Annotated[float, Field(ge=0.0, lt=1.0)] | None]
