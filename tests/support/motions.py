"""Motions of joints that several tests follow, with their derivatives."""

from pathlib import Path

import numpy as np


def to_and_fro(swing, h: float, lasts: float, home=0.0):
    """Return desired joints, shape (n, 3, nq): quintics from home by a swing and back, 1.5 s each way.

    Args:
        swing: Way of each joint, in rad, shape (nq,).
        h: Time between rows, in s.
        lasts: Time of the last row, in s.
        home: Where the joints start, in rad.
    """
    t = h * np.arange(round(lasts / h) + 1)
    back = t % 3.0 >= 1.5
    u = np.where(back, 3.0 - t % 3.0, t % 3.0) / 1.5
    sign = np.where(back, -1.0, 1.0)
    s = 10.0 * u**3 - 15.0 * u**4 + 6.0 * u**5
    ds = sign * (30.0 * u**2 - 60.0 * u**3 + 30.0 * u**4) / 1.5
    dds = (60.0 * u - 180.0 * u**2 + 120.0 * u**3) / 1.5**2
    way = np.multiply.outer(np.stack([s, ds, dds], axis=1), swing)
    way[:, 0] += home
    return way


def write_joints(path: Path, q, h: float) -> Path:
    """Write joint positions, shape (n, 3), every h seconds, as a trajectory's file."""
    table = np.column_stack([h * np.arange(len(q)), q])
    np.savetxt(path, table, delimiter=",", header="t,q1,q2,q3", comments="", fmt="%.15g")
    return path
