"""Base classes of plants: torque-driven, position-driven, and wrapped around another plant."""

import numpy as np

from runner.base.arrays import FloatArray


class Plant:
    """A simulated arm under torques that are held between control ticks. It has no access to the controller.

    A plant must define `reset`, `set_gravity` and `advance`; the other methods have defaults.

    Attributes:
        q: True joint positions, shape (nq,), in rad; updated in place by reset and advance.
        dq: True joint velocities, shape (nq,), in rad/s; updated in place by reset and advance.
        load: External joint torques in the next tick, shape (nq,), in N m, written in place; None if the plant adds
            them to the motor torques.
        bends: True if links bend, so that end points do not follow from the joints; see `end_points`.
    """

    q: FloatArray
    dq: FloatArray
    load: FloatArray | None = None
    bends = False

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state."""
        raise NotImplementedError

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector in the arm's base frame, shape (3,), in m/s^2."""
        raise NotImplementedError

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques, shape (nq,), in N m, for one control tick of simulated time."""
        raise NotImplementedError

    def push(self, tau: FloatArray, load: FloatArray) -> None:
        """Hold motor torques and external torques, shapes (nq,), in N m, for one control tick."""
        if self.load is None:
            self.advance(tau + load)
        else:
            self.load[:] = load
            self.advance(tau)

    def close(self) -> None:
        """Release the resources of the plant."""

    @property
    def friction(self) -> FloatArray:
        """Torques that friction subtracted from the motor torques in the last tick, shape (nq,), in N m."""
        return np.zeros(len(self.q))

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> bool:
        """Add a flat frictionless wall for the tool; return True if the plant computes the contact.

        By default it does not. It then receives the force of the wall on the tool as joint torques, held for a tick. A
        tip without a tool touches walls by `WithTipContact`, on any plant.

        Args:
            point: A point on the face of the wall in the base frame, shape (3,), in m.
            normal: Unit vector out of the wall, shape (3,).
            stiffness: Stiffness of the wall, in N/m.
            damping: Damping of the wall, in N s/m.
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
        tau: Torques of the last tick, shape (nq,), in N m; updated in place by advance.
        load: External joint torques in the next tick, shape (nq,), in N m; written in place.
    """

    tau: FloatArray
    load: FloatArray


class PlantWrapper(Plant):
    """A plant around another one, for example for friction or servos; by default it forwards every call.

    Args:
        plant: The inner plant.
    """

    def __init__(self, plant: Plant) -> None:
        self.plant = plant
        self.q, self.dq, self.load, self.bends = plant.q, plant.dq, plant.load, plant.bends

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state."""
        self.plant.reset(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector."""
        self.plant.set_gravity(gravity)

    def close(self) -> None:
        """Release the resources of the plant."""
        self.plant.close()

    @property
    def friction(self) -> FloatArray:
        """Friction of the inner plant."""
        return self.plant.friction

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> bool:
        """Add a wall to the inner plant."""
        return self.plant.add_wall(point, normal, stiffness, damping)

    def contact_wrench(self) -> FloatArray | None:
        """Return the contact wrench of the inner plant."""
        return self.plant.contact_wrench()

    def tool_reaction(self) -> FloatArray | None:
        """Return the reaction that the inner plant computes."""
        return self.plant.tool_reaction()

    def end_points(self) -> FloatArray:
        """Return the end points of the inner plant."""
        return self.plant.end_points()

    def tip_motion(self) -> FloatArray:
        """Return the tip's motion of the inner plant."""
        return self.plant.tip_motion()


def unwrapped(plant: Plant) -> Plant:
    """Return the plant that moves the arm, inside all wrappers."""
    while isinstance(plant, PlantWrapper):
        plant = plant.plant
    return plant
