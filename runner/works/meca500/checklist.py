"""Every table, figure and formula of the Meca500 report, and where it stands in ours."""

from runner.reporting.checklist import Checklist

_CHECKED, _DONE = "checked in numbers", "carried out against known truth"
CHECKLIST = Checklist(
    title="Checklist: every table and formula of the report",
    text="The report's photographs and sketches are lost in the text that has come down to us.",
    complete="Nothing else is missing here.",
    caption="Tables and formulas of the report.",
    place="section",
    items=(
        ("Table 1, D-H parameters", "1", _CHECKED, "Kinematics, element by element"),
        ("Jacobian in frame 6, continued", "1", _CHECKED, "Kinematics, element by element"),
        ("Equations (1) to (5), four-point method", "2", _DONE, "Tool centre point"),
        ("Equation (6), direction of the tool", "3", _DONE, "Tool direction and alignment"),
        ("Equation (7) and Figure 1, alignment", "3", _DONE, "Tool direction and alignment"),
        ("Equations of gravity compensation", "4", _DONE, "Gravity compensation"),
        ("Equation (8), admittance", "5", _CHECKED, "Step response of each axis"),
        ("Equation (8) in the Laplace variable", "5", _CHECKED, "Frequency response"),
        ("Rotations and their Jacobians", "5", _CHECKED, "Step response of each axis"),
        ("Change of the reference frame", "6", _CHECKED, "Work at the tool tip"),
        ("Forward kinematics", "7.1", _CHECKED, "Kinematics, element by element"),
        ("Jacobian matrices", "7.2", _CHECKED, "Kinematics, element by element"),
    ),
)
