"""What the xArm7 report says, and where it is silent and a choice is ours."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from runner.reporting.document import Section, Table, Text
from runner.reporting.figures import model_of
from runner.reporting.quantities import number, quantity
from runner.store import Run


def source_section(runs: Mapping[str, Run]) -> Section:
    """Return what is printed beside what we chose."""
    run = runs["three_joints/sound"]
    config: Mapping[str, Any] = run.config
    A, B = (np.array(config["trajectory"][key]) for key in ("start", "goal"))
    period, tick = float(config["trajectory"]["duration"]), float(config["controller"]["period"])
    length = float(np.linalg.norm(B - A))
    peak = np.pi * length / period
    seven = runs["seven_joints/sound"].config["controller"]
    model = model_of(run)
    rows = [
        ["X and Z of the line", "0.643 and 0.1508", "as printed, in m; 0.643 may be a misprint of 0.6043"],
        ["A and B", "40 cm apart along y", f"y = {A[1]:g} and {B[1]:g} m, alike to both sides"],
        ["period of the motion", "not printed", f"{number(period)} s from A to B and back; two periods are shown"],
        [
            "easing",
            '"a sinusoidal function" of $P_(e y)$, no formula',
            f"harmonic: at most {quantity(peak, 'm/s')}, at rest in A and B",
        ],
        ["sampling rate", "not printed", f"{1.0 / tick:g} Hz, which the maker recommends"],
        [
            "simulator",
            "Gazebo; controller gains not printed",
            "joints that reach each command by the next, and where it is said servos on an arm with mass",
        ],
        ["$q_6$ of the first part", "0.75 rad, or $q_6$", f"{config['controller']['wrist']:g} rad, fixed"],
        [
            "orientation in the second part",
            "6 rows, but no orientation is said",
            "free (3 rows), or held as at home (6)",
        ],
        ["feedback in the second part", "not printed", f"{seven['gain']:g} 1/s of the tip's error"],
        ["joint limits, masses", "not printed", f"the maker's; {number(model.mass)} kg move"],
    ]
    return Section(
        "What the report says, and where it is silent",
        (
            Text(
                "A course report of two authors: the UFACTORY xArm7 in Gazebo moves its flange between two points, "
                "first by joints 1, 2 and 4 with inverse kinematics in closed form, then by all seven with the "
                'pseudo-inverse of the Jacobian. The first part works; of the second it says "the code is not '
                "functional\". Its graphs are lost in the text that has come down to us, with the axes' ranges."
            ),
            Table("What is printed, and what is simulated.", ["quantity", "report", "simulated"], rows),
        ),
    )
