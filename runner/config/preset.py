"""Config of a preset."""

from runner.registry import StrictModel


class PresetConfig(StrictModel):
    """A table of values that other groups take as `${preset.x}`; see there for what they mean.

    Attributes:
        gravity_compensation: For controllers.
        feedforward: For controllers.
    """

    gravity_compensation: bool
    feedforward: bool
