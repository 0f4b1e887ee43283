"""Margins of a run to joint limits and singularities, and its warnings."""

from typing import Any

import numpy as np

from runner.reporting.document import Series
from runner.reporting.figures import joint_columns, model_of
from runner.store import Run
from runner.studies.meca500.figures import Runs
from runner.study.run_values import clock


def joint_speeds(runs: Runs, run: str) -> list[Series]:
    """Return the speeds of joints 1, 2, 3 and 5 as shares of their limits."""
    shares = joint_columns(runs[run].trace, "dq") / model_of(runs[run]).velocity_limits
    return [Series(f"joint {joint}", clock(runs[run]), shares[:, joint - 1]) for joint in (1, 2, 3, 5)]


def limits(run: Run) -> dict[str, Any]:
    """Return how close a run comes to limits, and what it says of itself.

    margin to a position limit in rad, below zero beyond it; as shares of the speed limit the largest speed and change
    of speed from tick to tick; the smallest singular value of the tip's Jacobian as a share of that at the start.
    """
    model, q = model_of(run), joint_columns(run.trace, "q")
    speeds = joint_columns(run.trace, "dq") / model.velocity_limits
    singular = [np.linalg.svd(model.tip_jacobian(own), compute_uv=False)[-1] for own in q[::10]]
    said = "; ".join(map(str, run.provenance["warnings"]))
    return {
        "margin": float(model.limit_margins(q).min()),
        "speed": float(np.abs(speeds).max()),
        "change": float(np.abs(np.diff(speeds, axis=0)).max()),
        "singular": float(min(singular) / singular[0]),
        "said": said.replace("the posture, singular or nearly so", "a posture at or near a singularity").replace(
            " has held the tool back, first at t =", " from"
        ),
        "told": "has held the tool back" in said,
    }
