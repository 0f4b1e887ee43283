"""Table 1 of the Meca500 report, modified D-H parameters, with the turns that its text has lost put back.

theta_2 stands for q_2 - 90 deg: without the turn, the tip is 0.34 m off on average. theta_6 stands for q_6 + 180 deg,
which the report's printed elements imply. The report gives lengths in mm.
"""

from math import pi

from runner.robots.denavit_hartenberg import ModifiedRow

TABLE = (
    ModifiedRow(alpha=0.0, a=0.0, theta=0.0, d=0.135),
    ModifiedRow(alpha=-pi / 2, a=0.0, theta=-pi / 2, d=0.0),
    ModifiedRow(alpha=0.0, a=0.135, theta=0.0, d=0.0),
    ModifiedRow(alpha=-pi / 2, a=0.038, theta=0.0, d=0.12),
    ModifiedRow(alpha=pi / 2, a=0.0, theta=0.0, d=0.0),
    ModifiedRow(alpha=-pi / 2, a=0.0, theta=pi, d=0.07),
)
"""Rows 1 to 6, in m and rad; frame 6 is the URDF's flange, z outwards."""
