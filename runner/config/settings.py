"""Config keys at the root of a run, and values of a preset."""

from typing import Annotated, Literal

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from runner.schema.model import StrictModel
from runner.schema.units import Acceleration, Seconds


class RunSettings(StrictModel):
    """The keys at the root of a config.

    Attributes:
        seed: Seed of all random numbers, together with the number of the repetition.
        repetitions: Number of closed-loop runs in the job.
        duration: Length of a run, in s; None takes the duration of the trajectory.
        gravity: Magnitude of gravity along -z of the base, in m/s^2, for the plant and the controllers' model.
        plant_error: True to repeat repetition 0 on Runge-Kutta, and from a moved start; see
            runner/caveats/integration_error.py and rounding.py.
        outputs: Folder in which runs are stored.
    """

    seed: NonNegativeInt
    repetitions: PositiveInt
    duration: Seconds[PositiveFloat | None]
    gravity: Acceleration[NonNegativeFloat]
    plant_error: bool
    outputs: Annotated[str, Field(min_length=1)]


class PresetConfig(StrictModel):
    """A table of values that other groups take as `${preset.x}`; those groups explain them.

    Attributes:
        gravity_compensation: Value for controllers.
        feedforward: Value for controllers.
        macro_target: Value for stage-wise control.
        mini_reference_velocity: Value for stage-wise control.
        wrist_rotation: Value for stage-wise control and plants.
        dynamics: Value for plants.
    """

    gravity_compensation: bool
    feedforward: bool
    macro_target: Literal["minus_home", "tip_goal"]
    mini_reference_velocity: Literal["zero", "full"]
    wrist_rotation: Literal["real", "parallel"]
    dynamics: Literal["coupled", "decoupled"]
