"""A composed config before its check."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

CALIBRATION = "calibrate"
"""Root of the config of a calibration; the root of the config of a run is "config"."""


@dataclass(frozen=True)
class Composed:
    """A composed config before validation.

    Attributes:
        resolved: The config as plain data, with interpolations resolved and quantities such as 20ms in SI units.
        overrides: The overrides of the composition, as typed.
        choices: The option chosen in each group, such as {"robot": "macro"}.
        config_dirs: Config folders of the user.
        root: Name of the root file in conf/: "config" for a run, "calibrate" for a calibration.
    """

    resolved: Mapping[str, object]
    overrides: tuple[str, ...] = ()
    choices: Mapping[str, str] = field(default_factory=dict)
    config_dirs: tuple[Path, ...] = ()
    root: str = "config"
