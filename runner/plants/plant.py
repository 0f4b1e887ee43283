"""Plant protocols: torque and position inputs, external joint torques, contact, tool reaction and end points."""

from typing import Protocol, runtime_checkable

from runner.base.arrays import FloatArray


class Plant(Protocol):
    """A simulated arm under torques that are held between control ticks. It never sees the controller."""

    @property
    def q(self) -> FloatArray:
        """True joint positions, shape (nq,), in rad; renewed in place by reset and advance."""
        ...

    @property
    def dq(self) -> FloatArray:
        """True joint velocities, shape (nq,), in rad/s; likewise."""
        ...

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state."""

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector in the arm's base frame, shape (3,), in m/s^2."""

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques, shape (nq,), in N m, for one control tick of simulated time."""

    def close(self) -> None:
        """Release what the plant holds."""


class PositionPlant(Plant, Protocol):
    """A simulated arm whose joints follow commanded positions; `advance` takes these, shape (nq,), in rad."""

    @property
    def tau(self) -> FloatArray:
        """Torques of the tick that `advance` just made, shape (nq,), in N m; renewed in place."""
        ...

    @property
    def load(self) -> FloatArray:
        """Joint torques that the world adds in the next tick, shape (nq,), in N m; written in place."""
        ...


@runtime_checkable
class PlantWrapper(Protocol):
    """What acts on another plant, as servos and friction do."""

    @property
    def plant(self) -> Plant:
        """The plant that it acts on."""
        ...


@runtime_checkable
class ReportsContact(Protocol):
    """A plant that tells what the world puts on the arm while it moves it."""

    def contact_wrench(self) -> FloatArray:
        """Return the wrench of the wall on the arm at the end of the last tick, shape (6,).

        Force in N, moment about the base's origin in N m, along its axes.
        """
        ...


@runtime_checkable
class ContactPlant(ReportsContact, Protocol):
    """A plant that makes the contact of a tool with a wall itself.

    One that does not gets the wall's force on the tool as joint torques, held for a tick. A tip without a tool touches
    walls by `WithTipContact`, on any plant.
    """

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> None:
        """Put up a flat frictionless wall that gives way.

        Args:
            point: A point of its face in the base frame, shape (3,), in m.
            normal: Unit vector out of it, shape (3,).
            stiffness: In N/m.
            damping: In N s/m.
        """


@runtime_checkable
class ToolReactionPlant(Protocol):
    """A plant that computes the reaction in the tool's mount, which stands in the trace for comparison."""

    def tool_reaction(self) -> FloatArray | None:
        """Return what the tool puts on the flange; None where there is no tool.

        Force in N and moment about the flange's origin in N m, along the base's axes, shape (6,).
        """
        ...


def unwrapped(plant: Plant) -> Plant:
    """Return the plant that moves the arm, below servos and friction."""
    while isinstance(plant, PlantWrapper):
        plant = plant.plant
    return plant


@runtime_checkable
class TellsEndPoints(Protocol):
    """A plant of ours whose stages end elsewhere than its joints tell, as its links bend."""

    def end_points(self) -> FloatArray:
        """Return the end point of each stage now, shape (stages, 3), in m; see runner.robots.robot.end_points."""
        ...

    def tip_motion(self) -> FloatArray:
        """Return position and velocity of the tip now, shape (2, 3), in m and m/s."""
        ...


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
