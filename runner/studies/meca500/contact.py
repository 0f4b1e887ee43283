"""Measured and true contact forces at walls of known stiffness."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.figures import columns
from runner.store import Run
from runner.studies.meca500.figures import law_of, servo_compliance, wrenches


def as_felt(run: Run) -> FloatArray:
    """Return the wall's push as it is felt, shape (T,), in N; what is felt is the reading of a tick before."""
    return np.append(-wrenches(run, "felt")[1:, 0], np.nan)


def forces(run: Run) -> dict[str, float]:
    """Return the forces against the way into a wall, in N, how far in the spring's rest is led, in m, and shares.

    The force felt at the end is held against the wall's stiffness times the depth of the tip, and against the springs
    of law, wall and servos in series: off_depth and off_series say by which share it is above them.
    """
    wall, trajectory = run.config["environment"], run.config["trajectory"]
    begin = float(trajectory["start"][0] + wall["distance"])
    way, stiffness = float(trajectory["goal"][0]) - begin, float(wall["stiffness"])
    felt, peak = float(-wrenches(run, "felt")[-1, 0]), float(-wrenches(run, "external")[:, 0].min())
    soft = float(servo_compliance(run)[0, 0]) if run.config["plant"]["kind"] != "kinematic" else 0.0
    series = way / (1.0 / float(law_of(run).stiffness[0]) + 1.0 / stiffness + soft)
    off_depth = felt / (stiffness * (float(columns(run.trace, "tip")[-1, 0]) - begin)) - 1.0
    return {"way": way, "felt": felt, "peak": peak, "first": peak / felt, "series": series, "off_depth": off_depth,
            "off_series": felt / series - 1.0}  # fmt: skip
