"""A sweep by hand: two controllers, two loads, three seeds of four repetitions; load 2 is worse by far."""

import numpy as np

from runner.store.axes import Axis
from runner.sweeps.measurements import Measurements

CONTROLLERS, LOADS, SEEDS = ["computed_torque", "operational_space"], [0.5, 2.0], [0.0, 1.0, 2.0]


def by_hand() -> Measurements:
    """Return twelve cells, the seed changing fastest, in metres, newton metres and a user's unit."""
    controller, load, seed = (places.ravel() for places in np.meshgrid([0, 1], [0, 1], [0, 1, 2], indexing="ij"))
    draws = np.random.default_rng(3).normal(size=(12, 4))
    error = 0.005 + 0.001 * controller[:, None] + 0.02 * load[:, None] + 1e-4 * draws
    return Measurements(
        axes=[
            Axis("controller", CONTROLLERS, controller),
            Axis("robot.payload.mass", LOADS, load),
            Axis("seed", SEEDS, seed),
        ],
        fixed=["robot=macro"],
        hashes=[f"run{cell}" for cell in range(12)],
        statuses=["ok"] * 12,
        failures=[""] * 12,
        units={"rms_tracking_error": "m", "peak_torque": "N m", "own_cost": "GBP/m^2"},
        values={"rms_tracking_error": error, "peak_torque": 50.0 + draws, "own_cost": 1e-7 * (5.0 + draws)},
        provenance={"commit": ["abc"]},
    )
