"""Config of a preset."""

from typing import Literal

from runner.schema.model import StrictModel


class PresetConfig(StrictModel):
    """A table of values that other groups take as `${preset.x}`; see there for what they mean.

    Attributes:
        gravity_compensation: For controllers.
        feedforward: For controllers.
        macro_target: For stage-wise control.
        mini_reference_velocity: For stage-wise control.
        wrist_rotation: For stage-wise control and plants.
        dynamics: For plants.
    """

    gravity_compensation: bool
    feedforward: bool
    macro_target: Literal["minus_home", "tip_goal"]
    mini_reference_velocity: Literal["zero", "full"]
    wrist_rotation: Literal["real", "parallel"]
    dynamics: Literal["coupled", "decoupled"]
