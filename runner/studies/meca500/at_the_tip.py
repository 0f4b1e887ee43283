"""Measured moment and commanded rotation under a force through the tip."""

import numpy as np

from runner.controllers.force.admittance_filter import AdmittanceFilter
from runner.store import Run
from runner.studies.meca500.figures import law_of, wrenches


def felt_moment(run: Run) -> float:
    """Return the largest moment felt along an axis, in N m."""
    return float(np.abs(wrenches(run, "felt")[:, 3:]).max())


def filtered_turn(run: Run) -> float:
    """Return the largest rotation that the law makes of the wrenches felt in a run, in rad."""
    law = AdmittanceFilter(law_of(run), float(run.config["controller"]["period"]))
    largest = 0.0
    for wrench in wrenches(run, "felt"):
        law.step(wrench)
        largest = max(largest, float(np.linalg.norm(law.displacement[3:])))
    return largest
