"""Calibration procedures on a simulated arm, with known true values."""

from runner.calibration.procedures.bench import Bench
from runner.calibration.procedures.procedure import Outcome, Procedure
from runner.plugins.registry import KindConfig, Registry

CALIBRATIONS = Registry[KindConfig, [Bench], Procedure](
    "calibration",
    {
        "gravity": "runner.calibration.procedures.gravity",
        "tool_centre_point": "runner.calibration.procedures.tool_centre_point",
        "tool_direction": "runner.calibration.procedures.tool_direction",
    },
)

__all__ = ["CALIBRATIONS", "Bench", "Outcome", "Procedure"]
