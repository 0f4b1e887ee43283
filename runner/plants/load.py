"""External joint torques on a plant, separate from the motor torques."""

from typing import Protocol, runtime_checkable

from runner.base.arrays import FloatArray
from runner.plants.plant import Plant


@runtime_checkable
class TakesLoad(Protocol):
    """A plant whose motors do not move its links alone, so that the world's torques count beside theirs."""

    @property
    def load(self) -> FloatArray:
        """Joint torques that the world adds in the next tick, shape (nq,), in N m; written in place."""
        ...


def push(plant: Plant, tau: FloatArray, load: FloatArray) -> None:
    """Hold torques of motors and of the world, shapes (nq,), in N m, for one control tick; see Plant.advance."""
    if isinstance(plant, TakesLoad):
        plant.load[:] = load
        plant.advance(tau)
    else:
        plant.advance(tau + load)
