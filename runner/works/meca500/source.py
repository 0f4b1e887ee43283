"""What the Meca500 report says, where it is silent, and where it is wrong."""

from collections.abc import Mapping
from typing import Any

from runner.reporting.document import Section, Table, Text
from runner.reporting.figures import origin
from runner.store import Run
from runner.works.meca500.plan import REPORTED
from runner.works.meca500.step_response import law_of


def source_section(runs: Mapping[str, Run]) -> Section:
    """Return what is silent with our choices, and the misprints with their right forms."""
    run = runs["hand/lab"]
    tool: Mapping[str, Any] = run.config["robot"]["tool"]
    sensor: Mapping[str, Any] = run.config["wrist_sensor"]
    law = law_of(runs["step/kinematic, 1 ms/x"])
    return Section(
        "What the report says, where it is silent, and where it is wrong",
        (
            Text(
                "A report on a Mecademic Meca500 for dental work: its kinematics, how the tip and the direction of a "
                "root-canal file are found, how the tool's weight is taken off a force/torque sensor, and how the arm, "
                "which has no force control of its own, is made to give way. It prints methods and formulas and no "
                "measured number, so that there is nothing to compare with but the truth, which a simulation has. Its "
                "figures are lost in the text that has come down to us."
            ),
            Table(
                "Where it is silent, and what is simulated.",
                ["quantity", "report", "simulated"],
                [
                    [
                        "M, B and K",
                        "not printed",
                        f"{law.mass[0]:g} kg, {law.damping[0]:g} N s/m, {law.stiffness[0]:g} N/m; "
                        f"{law.mass[3]:g} kg m², {law.damping[3]:g} N m s/rad, {law.stiffness[3]:g} N m/rad",
                    ],
                    [
                        "how the law is sampled",
                        "in the Laplace variable alone",
                        "exactly, for a load that is held over a period",
                    ],
                    [
                        "sample time",
                        "not printed",
                        f"1 ms, and {1e3 * REPORTED:g} ms, at which the real controller reports",
                    ],
                    [
                        "rotation under a moment",
                        "three angles, and the Euler rates' Jacobian",
                        "that of a body: angular velocity along fixed axes, spring along the rotation vector",
                    ],
                    [
                        "sensor",
                        '"F/T sensor"',
                        f"Mini40: range {sensor['range'][0]:g} N, step {sensor['resolution'][0]:g} N, "
                        f"noise {sensor['noise'][0]:g} N",
                    ],
                    [
                        "tool",
                        "a root-canal file, no numbers",
                        f"{tool['mass']:g} kg, its tip {1e3 * tool['tip'][2]:g} mm from the flange",
                    ],
                    [
                        "inertia of the tool in motion",
                        "not said: gravity alone is compensated",
                        "compensated too, by velocity and differenced acceleration",
                    ],
                    [
                        "$r_(i j)$ of section 4",
                        "not defined",
                        'elements of the inverse rotation $""_0^6 R$, with which the section\'s equations are right; '
                        'with $""_6^0 R$ they are not',
                    ],
                    ["walls, hands, limits of joints", "not said", "springs and dampers of known numbers"],
                ],
                origin=origin(run),
            ),
            Table(
                "Where it is wrong, or its text is damaged; each is corrected here, and its effect is shown in "
                "numbers below.",
                ["place", "printed", "right", "what follows"],
                [
                    [
                        "Table 1",
                        "$theta_2$, $theta_6$",
                        "$q_2 - 90°$, $q_6 + 180°$",
                        "the tip in another place; axes turned by half a turn",
                    ],
                    [
                        "1, row 2 of the Jacobian in frame 6",
                        "$sqrt(23961)$",
                        "$2 sqrt(3961) = sqrt(120^2 + 38^2)$ times 1 mm",
                        "a wrong speed along z of frame 6 as joint 1 turns",
                    ],
                    [
                        "1 and 7.2, angular rows",
                        "terms with a bare $theta_i$",
                        "the joint axes alone",
                        "no velocity Jacobian: it changes with whole turns of a joint",
                    ],
                    [
                        "4, first equations",
                        "$G_z = F_y - F_(y 0)$, $G_y = F_z - F_(z 0)$",
                        "y and z in their places",
                        "gravity's y and z exchanged",
                    ],
                    [
                        "4, first equations",
                        "$M_(g x) = M_x - F_(x 0)$, and likewise y, z",
                        "$M_(x 0)$, $M_(y 0)$, $M_(z 0)$",
                        "N taken from N m",
                    ],
                    [
                        "4, last line",
                        "$arccos$ or $arcsin$",
                        '$op("atan2")(G sin theta, G cos theta)$',
                        "half of all angles come out wrong",
                    ],
                    [
                        "6",
                        "$M_p$ on the second line",
                        "$M_q$",
                        "the moment about the wrong point on one of three lines",
                    ],
                ],
                origin=origin(run),
            ),
        ),
    )
