"""Whether contact in a run is unstable, as observed."""

import numpy as np

from runner.store import Run
from runner.works.meca500.signals import wrenches

_STILL = 1e-4  # N, below which a force that swings is rounding


def bounces(run: Run) -> bool:
    """Tell whether contact is unstable as observed.

    It is where in the last third of a run the tip leaves the wall, or the force swings more widely than in the third
    before.
    """
    force = -wrenches(run, "external")[:, 0]
    third = len(force) // 3
    before, last = force[third : 2 * third], force[-third:]
    return bool(last.min() <= 0.0 or np.ptp(last) > max(np.ptp(before), _STILL))
