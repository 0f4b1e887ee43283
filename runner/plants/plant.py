"""Base classes of plants: torque-driven, position-driven, and wrapped around another plant."""

import numpy as np

from runner.base.arrays import FloatArray


class Plant:
    """A simulated arm under torques that are held between control ticks. It never sees the controller.

    A plant must define `reset`, `set_gravity` and `advance`; the rest has defaults.

    Attributes:
        q: True joint positions, shape (nq,), in rad; renewed in place by reset and advance.
        dq: True joint velocities, shape (nq,), in rad/s; likewise.
        load: Joint torques of the world in the next tick, shape (nq,), in N m, written in place; None if the plant
            adds them to the torques of the motors.
        bends: True if stages end elsewhere than the joints tell, because links bend; see `end_points`.
    """

    q: FloatArray
    dq: FloatArray
    load: FloatArray | None = None
    bends = False

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state."""
        raise NotImplementedError

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector in the arm's base frame, shape (3,), in m/s^2."""
        raise NotImplementedError

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques, shape (nq,), in N m, for one control tick of simulated time."""
        raise NotImplementedError

    def push(self, tau: FloatArray, load: FloatArray) -> None:
        """Hold torques of motors and of the world, shapes (nq,), in N m, for one control tick."""
        if self.load is None:
            self.advance(tau + load)
        else:
            self.load[:] = load
            self.advance(tau)

    def close(self) -> None:
        """Release what the plant holds."""

    @property
    def friction(self) -> FloatArray:
        """Torques that friction subtracted from those of the motors in the last tick, shape (nq,), in N m."""
        return np.zeros(len(self.q))

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> bool:
        """Add a flat frictionless wall for the tool; return True if the plant computes the contact.

        By default it does not. It then gets the force of the wall on the tool as joint torques, held for a tick. A tip
        without a tool touches walls by `WithTipContact`, on any plant.

        Args:
            point: A point of its face in the base frame, shape (3,), in m.
            normal: Unit vector out of it, shape (3,).
            stiffness: In N/m.
            damping: In N s/m.
        """
        return False

    def contact_wrench(self) -> FloatArray | None:
        """Return the wrench of the wall on the arm at the end of the last tick; None if the plant computes no contact.

        Force in N, moment about the base's origin in N m, along its axes, shape (6,).
        """
        return None

    def tool_reaction(self) -> FloatArray | None:
        """Return the wrench of the tool on the flange that the plant computes, for comparison; None if there is none.

        Force in N and moment about the flange's origin in N m, along the base's axes, shape (6,).
        """
        return None

    def end_points(self) -> FloatArray:
        """Return the end point of each stage of a plant that bends, shape (stages, 3), in m."""
        raise NotImplementedError

    def tip_motion(self) -> FloatArray:
        """Return position and velocity of the tip of a plant that bends, shape (2, 3), in m and m/s."""
        raise NotImplementedError


class PositionPlant(Plant):
    """A simulated arm whose joints follow commanded positions; `advance` takes these, shape (nq,), in rad.

    Attributes:
        tau: Torques of the tick that `advance` just made, shape (nq,), in N m; renewed in place.
        load: Joint torques of the world in the next tick, shape (nq,), in N m; written in place.
    """

    tau: FloatArray
    load: FloatArray


class PlantWrapper(Plant):
    """A plant that acts on another one, as friction and servos do; by default it passes everything on.

    Args:
        plant: The other plant.
    """

    def __init__(self, plant: Plant) -> None:
        self.plant = plant
        self.q, self.dq, self.load, self.bends = plant.q, plant.dq, plant.load, plant.bends

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state."""
        self.plant.reset(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector."""
        self.plant.set_gravity(gravity)

    def close(self) -> None:
        """Release what the plant holds."""
        self.plant.close()

    @property
    def friction(self) -> FloatArray:
        """Friction of the other plant."""
        return self.plant.friction

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> bool:
        """Add a wall to the other plant."""
        return self.plant.add_wall(point, normal, stiffness, damping)

    def contact_wrench(self) -> FloatArray | None:
        """Return the contact of the other plant."""
        return self.plant.contact_wrench()

    def tool_reaction(self) -> FloatArray | None:
        """Return the reaction that the other plant computes."""
        return self.plant.tool_reaction()

    def end_points(self) -> FloatArray:
        """Return the end points of the other plant."""
        return self.plant.end_points()

    def tip_motion(self) -> FloatArray:
        """Return the motion of the tip of the other plant."""
        return self.plant.tip_motion()


def unwrapped(plant: Plant) -> Plant:
    """Return the plant that moves the arm, inside all wrappers."""
    while isinstance(plant, PlantWrapper):
        plant = plant.plant
    return plant
