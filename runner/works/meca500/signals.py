"""Signals of a run that feels: wrenches, and how the tool has turned and moved."""

from itertools import product

import numpy as np
import pinocchio as pin

from runner.reporting.document import FloatArray
from runner.reporting.figures import AXES, columns, joint_columns, model_of
from runner.store import Run


def wrenches(run: Run, signal: str) -> FloatArray:
    """Return a signal such as "felt" at each tick, force in N and moment in N m, shape (T, 6)."""
    names = [f"{signal}_{kind}_{axis}" for kind, axis in product(("force", "moment"), AXES)]
    rows: FloatArray = run.trace[names].to_numpy()
    return rows


def turns(run: Run) -> FloatArray:
    """Return the rotation vector of the tip since the first row, along the base's axes, shape (T, 3), in rad."""
    model, rows = model_of(run), joint_columns(run.trace, "q")
    first = model.tip_pose(rows[0])[:3, :3]
    return np.array([pin.log3(model.tip_pose(q)[:3, :3] @ first.T) for q in rows])


def displacement(run: Run) -> FloatArray:
    """Return how far the tip has gone and turned since the first row, shape (T, 6), in m and rad."""
    tip = columns(run.trace, "tip")
    return np.hstack([tip - tip[0], turns(run)])
