"""Runtime checks of plant plug-ins."""

from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, SimulationError
from runner.plugins.guard.faults import ask, checked, told_of_part
from runner.plugins.guard.read_only import read_only

_WHENEVER = float("nan")  # the loop knows the time, and puts it in


class WatchedPlant:
    """A plant of the user's that ends the run as a failure where it raises, or has a state of another shape.

    Args:
        plant: What is watched; see Plant and PositionPlant.
        moved: What in it moves the arm; see unwrapped.
    """

    def __init__(self, plant: Any, moved: Any) -> None:
        self._plant = plant
        self._moved = moved

    @property
    def q(self) -> FloatArray:
        """Its joint positions."""
        return self._have("q")

    @property
    def dq(self) -> FloatArray:
        """Its joint velocities."""
        return self._have("dq")

    @property
    def tau(self) -> FloatArray:
        """Its torques, of one that follows joint positions."""
        return self._have("tau")

    @property
    def load(self) -> FloatArray:
        """The world's torques on it, of one that follows joint positions."""
        return self._have("load")

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state."""
        ask(self._plant.reset, 0.0, read_only(q), read_only(dq))
        for name in ("q", "dq"):
            found = np.shape(self._have(name))
            if found != q.shape:
                kind = type(self._plant).__name__
                raise SimulationError(f"{kind}.{name} has the shape {found}; it must be {q.shape}", 0.0)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector."""
        ask(self._plant.set_gravity, _WHENEVER, read_only(gravity))

    def advance(self, command: FloatArray) -> None:
        """Advance the plant by a tick."""
        ask(self._plant.advance, _WHENEVER, read_only(command))

    def close(self) -> None:
        """Release what the plant holds."""
        self._plant.close()

    def _have(self, name: str) -> FloatArray:
        found: FloatArray = ask(lambda: getattr(self._plant, name), _WHENEVER)
        return found


class WatchedContactPlant(WatchedPlant):
    """A plant of the user's that makes contacts itself; see ContactPlant."""

    def contact_wrench(self) -> FloatArray:
        """Return its wrench of the wall on the arm."""
        part = self._moved.contact_wrench
        return checked(ask(part, _WHENEVER), (6,), part, _WHENEVER)

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> None:
        """Put up a wall.

        Raises:
            ConfigError: where it raises; names the place.
        """
        try:
            self._moved.add_wall(read_only(point), read_only(normal), stiffness, damping)
        except Exception as error:
            raise ConfigError([f"plant.kind: its add_wall: {told_of_part(error)}"]) from error


class WatchedToolPlant(WatchedPlant):
    """A plant of the user's that computes the reaction in the tool's mount; see ToolReactionPlant."""

    def tool_reaction(self) -> FloatArray | None:
        """Return its reaction in the tool's mount."""
        part = self._moved.tool_reaction
        found = ask(part, _WHENEVER)
        return None if found is None else checked(found, (6,), part, _WHENEVER)


class WatchedContactToolPlant(WatchedContactPlant, WatchedToolPlant):
    """A plant of the user's that does both."""


def watch_plant(plant: Any, *_: object) -> WatchedPlant:
    """Return a plant of the user's watched, with all that it offers."""
    from runner.plants.plant import ContactPlant, ToolReactionPlant, unwrapped

    moved = unwrapped(plant)
    makes_contact, has_reaction = isinstance(moved, ContactPlant), isinstance(moved, ToolReactionPlant)
    if makes_contact:
        return (WatchedContactToolPlant if has_reaction else WatchedContactPlant)(plant, moved)
    return (WatchedToolPlant if has_reaction else WatchedPlant)(plant, moved)
