"""Modified (proximal) Denavit-Hartenberg table of an arm, Craig's convention, which the Meca500 report uses."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from runner.base.arrays import FloatArray


@dataclass(frozen=True)
class ModifiedRow:
    """Row of a modified (proximal, Craig's) D-H table: joint i turns about z_i, and frame i is on the axis of joint i.

    Attributes:
        alpha: Angle from z_{i-1} to z_i about x_{i-1}, in rad.
        a: Distance from z_{i-1} to z_i along x_{i-1}, in m.
        theta: Angle from x_{i-1} to x_i about z_i at q_i = 0, in rad; the joint position is added to it.
        d: Distance from x_{i-1} to x_i along z_i, in m.
    """

    alpha: float
    a: float
    theta: float
    d: float


def modified_transform(row: ModifiedRow, q: float) -> FloatArray:
    """Return Rx(alpha) Tx(a) Rz(theta + q) Tz(d), from frame i to frame i-1, at q in rad, shape (4, 4)."""
    c, s = np.cos(row.theta + q), np.sin(row.theta + q)
    ca, sa = np.cos(row.alpha), np.sin(row.alpha)
    return np.array(
        [
            [c, -s, 0.0, row.a],
            [s * ca, c * ca, -sa, -sa * row.d],
            [s * sa, c * sa, ca, ca * row.d],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def modified_frames(rows: Sequence[ModifiedRow], q: FloatArray) -> FloatArray:
    """Return frames 0 to n in frame 0 at joint positions q, shape (n + 1, 4, 4)."""
    transforms = (modified_transform(row, float(q_i)) for row, q_i in zip(rows, q, strict=True))
    return np.array(list(accumulate(transforms, np.matmul, initial=np.eye(4))))
