"""Data for another program that runs a closed loop: the arm, its law's numbers, path, encoders and limits."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.run_config import RunConfig
from runner.controllers.operational_space.operational_space import OperationalSpaceConfig
from runner.controllers.operational_space.whole_body import WholeBodyConfig
from runner.simulation.sensors import make_encoders

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class TipLoop:
    """A closed loop around an arm's tip, at rest at first, with one integration step in a tick or several.

    The law asks for the joint acceleration a_0 + J^+ (F* - dJ/dt dq - J a_0), and a_0 = -k_v dq - k_p S (q - rest): the
    runner's, but with the plain pseudo-inverse where that weighs with the mass matrix, nothing done near a singular
    configuration, and the joints of mounted stages held by an acceleration instead of a spring. The tip moves alike.

    Attributes:
        urdf: The arm's URDF text.
        tip: Name of the frame that is led.
        gravity: In m/s^2.
        law: k_p and k_v of the tip, k_p and k_v of the posture, in 1/s^2 and 1/s.
        held: Diagonal of S: which joints are drawn home, shape (nq,).
        rest: Home, shape (nq,), in rad.
        limits: Torque limit of each joint, shape (nq,), in N m.
        start: Joint positions at the start, shape (nq,), in rad.
        tick: Time between two ticks, in s.
        desired: Position, velocity and acceleration of the tip at each tick, shape (T + 1, 3, 3).
        errors: Errors of the measured positions at each tick, shape (T + 1, nq), in rad.
    """

    urdf: str
    tip: str
    gravity: float
    law: FloatArray
    held: FloatArray
    rest: FloatArray
    limits: FloatArray
    start: FloatArray
    tick: float
    desired: FloatArray
    errors: FloatArray

    @property
    def ticks(self) -> int:
        """T, the number of ticks."""
        return len(self.desired) - 1

    def log(self) -> FloatArray:
        """Return an array for joint positions, velocities and torques at each tick, shape (T + 1, 3, nq)."""
        return np.zeros((self.ticks + 1, 3, len(self.rest)))


def tip_loop(config: RunConfig, closed: ClosedLoop) -> TipLoop:
    """Return the closed loop of a run whose law leads the tip in operational space."""
    law, robot = config.controller, closed.robot
    assert isinstance(law, OperationalSpaceConfig | WholeBodyConfig)
    numbers = np.array([law.natural_frequency, law.null_space_frequency, law.damping_ratio], dtype=float)
    frequency, posture, damping = numbers.tolist()
    (encoders,) = make_encoders(closed, config.noise, config.settings.seed, 0)
    first_held = 0 if len(robot.stages) == 1 else 3  # as in runner/controllers/operational_space/whole_body.py
    return TipLoop(
        urdf=robot.urdf,
        tip=robot.model.tip_name,
        gravity=-float(robot.model.gravity[2]),
        law=np.array([frequency**2, 2.0 * damping * frequency, posture**2, 2.0 * posture]),
        held=(np.arange(robot.model.nq) >= first_held).astype(float),
        rest=robot.home,
        limits=closed.limits.max,
        start=closed.q_start,
        tick=closed.tick,
        desired=np.ascontiguousarray(closed.trajectory.sample(np.arange(closed.ticks + 1) * closed.tick)),
        errors=np.ascontiguousarray(encoders.errors),
    )
