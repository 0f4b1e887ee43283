"""Effect of MuJoCo's minimum inertia on accelerations."""

from runner.reporting.figures import model_of
from runner.store import Run
from runner.studies.engines.side_by_side import difference, mujoco_of


def acceleration_off(run: Run) -> float:
    """Return how far a MuJoCo run's accelerations are from Pinocchio's at random states at most, as a share."""
    return difference(model_of(run), mujoco_of(run)).acceleration
