"""Calibration of tool and force/torque sensor, with a covariance for every estimate."""

from runner.calibration.procedure import Bench, Procedure
from runner.plugins.registry import KindConfig, Registry

CALIBRATIONS = Registry[KindConfig, [Bench], Procedure](
    "calibration",
    {
        "gravity": "runner.calibration.weighing",
        "tool_centre_point": "runner.calibration.tool_centre_point",
        "tool_direction": "runner.calibration.tool_direction",
    },
)
