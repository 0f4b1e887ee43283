"""Every figure and formula of the xArm7 report, and where it stands in ours."""

from runner.reporting.checklist import Checklist

_REPRODUCED, _CHECKED, _WORKING = "reproduced", "checked in numbers", "not in the report, as its code did not work"
CHECKLIST = Checklist(
    title="Checklist: every figure and formula of the report",
    text=(
        "The report does not number its figures, and their images are lost in the text that has come down "
        "to us: the curves can be made again, not laid over the printed ones."
    ),
    complete="None is missing here.",
    caption="Figures and formulas of the report.",
    place="section of the report",
    items=(
        ("Sketch of the motion", "Description of the task", _REPRODUCED, "The line by three joints"),
        ("Transforms, A07 and P_e", "Position control with three joints", _CHECKED, "The tip's position"),
        ("Formulas of q1, q2 and q4", "Inverse kinematic control", _CHECKED, "Inverse kinematics"),
        ("Further solutions of q2 and q4", "Inverse kinematic control", _CHECKED, "The four ways to reach a point"),
        ("Jacobian, J11 to J67", "Jacobian matrix", _CHECKED, "Why the second part failed"),
        ("Trajectory planning", "Trajectory planning", _REPRODUCED, "The line by three joints"),
        ("Graphs of x, y and z", "Position control with three joints", _REPRODUCED, "The line by three joints"),
        ("Graphs of q1, q2 and q4", "Position control with three joints", _REPRODUCED, "The line by three joints"),
        ("Pseudo-inverse", "Position control with seven joints", _CHECKED, "Why the second part failed"),
        ("Graphs with seven joints", "Position control with seven joints", _WORKING, "The line by seven joints"),
    ),
)
