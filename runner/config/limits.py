"""Config of a sweep, and of the limits of CPU time and memory."""

import re
from typing import Annotated, Literal

from pydantic import BeforeValidator, PositiveFloat, PositiveInt

from runner.schema.model import StrictModel
from runner.schema.units import Seconds


class LimitsConfig(StrictModel):
    """Limits of CPU time and memory; an estimate above a limit stops a command before it starts.

    Attributes:
        cpu_hours: Largest CPU time of all runs of a command together, in hours; None for no limit.
        memory: Largest memory of one run, in GB (10^9 bytes), up to half of the machine's memory; None for that half.
    """

    cpu_hours: PositiveFloat | None
    memory: PositiveFloat | None


def split_part(text: str) -> tuple[int, int]:
    """Return number and count of a part, given as K/N.

    Raises:
        ValueError: if it is not a part.
    """
    found = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)
    if found is None or int(found[1]) >= int(found[2]):
        raise ValueError("must be K/N, such as 0/40, with whole numbers K from 0 to N - 1")
    return int(found[1]), int(found[2])


def _check_part(text: object) -> object:
    if text is not None:
        split_part(str(text))
    return text if text is None else str(text)


class SweepConfig(StrictModel):
    """Storage of a sweep's runs, and handling of runs that fail.

    Attributes:
        trace: Runs that keep their trace in a separate folder: all; sample, the failed ones and one in a hundred, about
            200 at most; failed; or never. auto means all for up to 3000 runs, and sample above.
        retry: Choice of runs to simulate again: those that failed in an earlier sweep, or none.
        on_failure: Reaction of the sweep to the first failed run.
        attempts: Number of attempts at a run that a time limit, an error or the loss of a worker interrupts.
        time_limit: Longest wall-clock time of a run, in s, after which it is interrupted; None for no limit.
        part: Part of the sweep to simulate, as K/N: the cells K, K + N, K + 2 N, ..., with K from 0 to N - 1. The parts
            have one sweep folder and may be simulated at once, also on several machines. None for all cells.
    """

    trace: Literal["auto", "all", "sample", "failed", "never"]
    retry: Literal["none", "failed"]
    on_failure: Literal["continue", "stop"]
    attempts: PositiveInt
    time_limit: Seconds[PositiveFloat | None]
    part: Annotated[str, BeforeValidator(_check_part)] | None
