"""Config keys at the root of a run."""

from typing import Annotated

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from runner.schema.model import StrictModel
from runner.schema.units import Acceleration, Seconds


class RunSettings(StrictModel):
    """The keys at the root of a config.

    Attributes:
        seed: Seed from which, with the repetition, every random number follows.
        repetitions: Number of closed-loop runs in the job.
        duration: Length of a run, in s; None leaves it to the trajectory.
        gravity: Magnitude of gravity along -z of the base, in m/s^2, for the plant and the controllers' model.
        plant_error: Whether the run is held against the same run on Runge-Kutta; see runner/metrics/plant_error.py.
        outputs: Folder in which runs are stored.
    """

    seed: NonNegativeInt
    repetitions: PositiveInt
    duration: Seconds[PositiveFloat | None]
    gravity: Acceleration[NonNegativeFloat]
    plant_error: bool
    outputs: Annotated[str, Field(min_length=1)]
