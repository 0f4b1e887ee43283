"""Metric: length of the path of the tip."""

import numpy as np

UNITS = {"path_length": "m"}


def evaluate(trace, context):
    """Return the length of the path.

    - path_length: length of the tip's path, summed over the control steps.
    """
    return {"path_length": float(np.linalg.norm(np.diff(trace.tip, axis=0), axis=1).sum())}
