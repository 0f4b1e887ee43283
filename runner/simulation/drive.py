"""Drives of the plant for one tick: torques, or joint positions to follow."""

from typing import Protocol, cast

from runner.base.arrays import FloatArray
from runner.plants import Plant, PositionPlant
from runner.plants.plant import push
from runner.simulation.closed_loop import ClosedLoop
from runner.simulation.recorder import Recorder


class PlantInput(Protocol):
    """What carries the loops' commands to the plant."""

    def advance(self, k: int, load: FloatArray | None) -> None:
        """Move the plant from tick k to the next one, under the world's joint torques, shape (nq,), in N m."""


class TorqueInput:
    """The loops' torques and the world's act on the plant together.

    Args:
        plant: The plant.
        recorder: Holds the commands, and tells which act.
    """

    def __init__(self, plant: Plant, recorder: Recorder) -> None:
        self._plant, self._timing, self._commands = plant, recorder.timing, recorder.commands

    def advance(self, k: int, load: FloatArray | None) -> None:
        """Move the plant; see PlantInput."""
        command = self._timing.at(self._commands, k)
        self._plant.advance(command) if load is None else push(self._plant, command, load)


class PositionInput:
    """The plant follows joint positions, and tells the torques that it took.

    Args:
        plant: The plant.
        recorder: Holds the commands, tells which act, and takes the torques.
    """

    def __init__(self, plant: PositionPlant, recorder: Recorder) -> None:
        self._plant, self._timing, self._commands = plant, recorder.timing, recorder.commands
        self._torques = recorder.torques

    def advance(self, k: int, load: FloatArray | None) -> None:
        """Move the plant; see PlantInput."""
        if load is not None:
            self._plant.load[:] = load
        self._plant.advance(self._timing.at(self._commands, k))
        self._torques[k] = self._torques[k + 1] = self._plant.tau


def make_plant_input(closed: ClosedLoop, recorder: Recorder) -> PlantInput:
    """Return what drives the plant of a closed loop, as its loops command it."""
    if closed.commands == "position":
        return PositionInput(cast(PositionPlant, closed.plant), recorder)
    return TorqueInput(closed.plant, recorder)
