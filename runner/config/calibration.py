"""Config of a calibration: the keys at its root."""

from typing import Annotated

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt

from runner.schema.model import StrictModel
from runner.schema.units import Acceleration


class CalibrationSettings(StrictModel):
    """The keys at the root of a calibration's config.

    Attributes:
        seed: Seed from which, with the repetition, every random number follows.
        repetitions: Number of calibrations in the job.
        gravity: Magnitude of gravity along -z of the base, in m/s^2.
        outputs: Folder in which calibrations are stored.
    """

    seed: NonNegativeInt
    repetitions: PositiveInt
    gravity: Acceleration[PositiveFloat]
    outputs: Annotated[str, Field(min_length=1)]
