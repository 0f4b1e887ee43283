"""Config of a sweep: storage of its runs and handling of failures, without effect on results."""

from typing import Literal

from pydantic import PositiveFloat, PositiveInt

from runner.schema.model import StrictModel
from runner.schema.units import Seconds


class SweepConfig(StrictModel):
    """How the runs of a sweep are kept, and what happens to those that fail.

    Attributes:
        trace: Which runs keep their trace, and with it a folder of their own: all, the failed ones and one in a
            hundred, some 200 at most (sample), the failed ones, or none; auto is all up to some thousand runs, sample
            above.
        retry: Whether runs that failed in an earlier sweep are simulated again.
        on_failure: What the first failed run does to the rest of the sweep.
        attempts: How often a run is tried that was cut short: by its time limit, an error, or a worker's death.
        time_limit: Longest wall-clock time of a run, in s, after which it is interrupted; None for no limit.
    """

    trace: Literal["auto", "all", "sample", "failed", "never"]
    retry: Literal["none", "failed"]
    on_failure: Literal["continue", "stop"]
    attempts: PositiveInt
    time_limit: Seconds[PositiveFloat | None]
