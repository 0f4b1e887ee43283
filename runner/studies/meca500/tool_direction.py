"""Tool direction and alignment (section 3 of the report), compared with the true direction."""

import numpy as np

from runner.calibration.tool_direction import alignment, alignment_angles
from runner.studies.meca500.figures import Calibrations, error
from runner.study.measured import Measured

_INSERTED = 0.02  # m, about the length of a root canal file


def direction(calibrations: Calibrations, worst: str) -> dict[str, Measured]:
    """Return the example's true angles, the angles off its direction by equation 7, and insertions by the worst."""
    base = calibrations["tool_direction/base"]
    t = np.array(base.config["calibration"]["direction"])
    t /= np.linalg.norm(t)
    R = alignment(*alignment_angles(t))
    off = [float(np.degrees(np.arccos(np.clip(along @ t, -1.0, 1.0)))) for along in (R.T[:, 2], R[:, 2])]
    return {
        "alpha": Measured("true alpha", float(np.degrees(base.truth["alpha"])), "°"),
        "beta": Measured("true beta", float(np.degrees(base.truth["beta"])), "°"),
        "printed": Measured("angle to the tool, read as printed", off[0], "°"),
        "described": Measured("angle to the tool, read as described", off[1], "°"),
        "inserted": Measured("way of insertion", 1e3 * _INSERTED, "mm"),
        "aside": Measured("how far the insertion ends aside", 1e6 * _INSERTED * error()(calibrations[worst]), "µm"),
    }
