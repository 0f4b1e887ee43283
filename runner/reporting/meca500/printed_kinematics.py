"""Elements of the report's appendix 7 as its text has them, for joint positions q: transform and Jacobians.

Lengths are in mm as printed. Elements whose text is whole are here; a term -C_2 stands for sin(theta_2 - 90 deg), with
theta_2 = q_2, and S_2 for its cosine.
"""

import math

import numpy as np

from runner.reporting.document import FloatArray
from runner.robots.denavit_hartenberg import in_last_frame, modified_frames, modified_jacobian
from runner.robots.meca500 import TABLE

MILLIMETRES = 1000.0
"""What one metre is in the report's unit of length."""


def printed_transform(q: FloatArray, factor: bool) -> dict[tuple[int, int], float]:
    """Return the elements of 0T6 of section 7.1 by row and column.

    Args:
        q: Joint positions, shape (6,), in rad.
        factor: Whether "-C_2" is read as a factor behind what it follows, or as a term of its own, as it is printed.
    """
    (S1, S2, S3, S4, S5, S6), (C1, C2, C3, C4, C5, C6) = np.sin(q), np.cos(q)

    def with_c2(value: float, sign: float = 1.0) -> float:
        """Return "sign value -C_2"."""
        return float(sign * value * -C2 if factor else sign * value - C2)

    u = with_c2(C1 * S3) - C1 * C3 * S2
    v = with_c2(C1 * C3) + C1 * S2 * S3
    w, b = with_c2(C3) + S2 * S3, C3 * S2 + with_c2(S3, -1.0)
    a = C5 * (S1 * S4 - C4 * u) - S5 * v
    return {
        (0, 0): -S6 * (C4 * S1 + S4 * u) - C6 * a,
        (0, 1): S6 * a - C6 * (C4 * S1 + S4 * u),
        (0, 2): -S5 * (S1 * S4 - C4 * u) - C5 * v,
        (0, 3): 135 * C1 * S2
        - 70 * S5 * (S1 * S4 - C4 * u)
        - 70 * C5 * v
        + with_c2(120 * C1 * C3, -1.0)
        - 120 * C1 * S2 * S3
        + with_c2(38 * C1 * S3, -1.0)
        + 38 * C1 * C3 * S2,
        (1, 2): S5 * (C1 * S4 - C4 * (C3 * S2 * S1 + with_c2(S1 * S3, -1.0))) - C5 * (with_c2(C3 * S1) + S2 * S1 * S3),
        (2, 0): C6 * (S5 * b + C4 * C5 * w) - S4 * S6 * w,
        (2, 1): -S6 * (S5 * b + C4 * C5 * w) - C6 * S4 * w,
        (2, 2): C4 * S5 * w - C5 * b,
    }


def printed_jacobian(q: FloatArray, angles: bool, root: float = 23961.0) -> dict[tuple[int, int], float]:
    """Return elements of the Jacobian in frame 6 of section 7.2 (printed in section 1 too), by row and column.

    Args:
        q: Joint positions, shape (6,), in rad.
        angles: Whether the terms with an angle as a factor stay, as printed.
        root: What stands in the root of row 2; 4 * 3961 is right.
    """
    _, t2, t3, t4, t5, t6 = q
    _, S2, S3, S4, S5, S6 = np.sin(q)
    _, _, C3, C4, C5, C6 = np.cos(q)
    bend = 135 * S2 + math.sqrt(root) * math.cos(t2 + t3 - math.atan(19 / 60))
    if not angles:
        t4 = t5 = t6 = 0.0
    row_x = (
        C4 * S6 + t6 * C4 * C6 - t4 * S4 * S6 + C5 * C6 * S4 + t4 * C4 * C5 * C6 - t5 * C6 * S4 * S5 - t6 * C5 * S4 * S6
    )
    row_y = (
        C4 * C6 - C5 * S4 * S6 - t4 * C6 * S4 - t6 * C4 * S6 - t4 * C4 * C5 * S6 - t6 * C5 * C6 * S4 + t5 * S4 * S5 * S6
    )
    row_z = S4 * S5 + t4 * C4 * S5 + t5 * C5 * S4
    return {
        (2, 0): S4 * S5 * bend,
        (2, 1): 38 * C5 + 135 * C3 * C5 + 120 * C4 * S5 - 135 * C4 * S3 * S5,
        (2, 2): 38 * C5 + 120 * C4 * S5,
        (3, 1): row_x,
        (3, 2): row_x,
        (3, 3): t6 * S5 * S6 - t5 * C5 * C6 - C6 * S5,
        (3, 4): S6 + t6 * C6,
        (4, 1): row_y,
        (4, 2): row_y,
        (4, 3): S5 * S6 + t5 * C5 * S6 + t6 * C6 * S5,
        (4, 4): C6 - t6 * S6,
        (5, 1): row_z,
        (5, 2): row_z,
        (5, 3): C5 - t5 * S5,
        (5, 4): 0.0,
        (5, 5): 1.0,
    }


def true_transform(q: FloatArray) -> FloatArray:
    """Return 0T6 from the modified D-H table, shape (4, 4), lengths in mm."""
    transform: FloatArray = modified_frames(TABLE, q)[-1]
    transform[:3, 3] *= MILLIMETRES
    return transform


def true_jacobian(q: FloatArray) -> FloatArray:
    """Return the geometric Jacobian in frame 6 from the modified D-H table, shape (6, 6), lengths in mm."""
    jacobian = in_last_frame(modified_jacobian(TABLE, q), modified_frames(TABLE, q)[-1][:3, :3])
    jacobian[:3] *= MILLIMETRES
    return jacobian
