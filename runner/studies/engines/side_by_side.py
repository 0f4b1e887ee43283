"""Comparison of an arm in an engine with the same arm in Pinocchio, at random states."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.plants.bullet import Bullet
from runner.plants.mujoco import Mujoco
from runner.robots.model import RobotModel
from runner.store import Run

STEP = 1e-3  # s
State = tuple[FloatArray, FloatArray, FloatArray]
"""Positions, velocities and torques of the joints."""
_STATES, _SEED = 20, 0
_SPEED, _ACCELERATION = 1.0, 10.0  # of random states, per joint: rad/s or m/s, and per s


@dataclass(frozen=True)
class Difference:
    """Relative differences of an engine from Pinocchio, the largest over the states.

    Attributes:
        mass: Of the mass matrix; Frobenius norm.
        acceleration: Of the accelerations under given torques.
        torque: Of the torques that Pinocchio says the engine's accelerations need.
    """

    mass: float
    acceleration: float
    torque: float


def bullet_of(run: Run) -> Bullet:
    """Return a run's arm in PyBullet; to be closed."""
    return Bullet(run.urdf, run.model, STEP, 1)


def mujoco_of(run: Run) -> Mujoco:
    """Return the arm of a run on MuJoCo in MuJoCo, with the run's least inertia, by Euler's scheme."""
    return Mujoco(run.urdf, run.model, STEP, 1, "euler", run.config["plant"]["min_inertia"])


def random_states(model: RobotModel) -> list[State]:
    """Return positions and velocities, and the torques of some accelerations there, by Pinocchio."""
    generator = np.random.default_rng(_SEED)
    low, high = np.clip(model.position_limits, -1.5, 1.5)
    states = []
    for _ in range(_STATES):
        q = generator.uniform(low, high)
        dq = generator.uniform(-_SPEED, _SPEED, model.nq)
        ddq = generator.uniform(-_ACCELERATION, _ACCELERATION, model.nq)
        states.append((q, dq, np.array(pin.rnea(model.pin_model, model.pin_model.createData(), q, dq, ddq))))
    return states


def difference(model: RobotModel, engine: Bullet | Mujoco) -> Difference:
    """Return the differences of an arm in an engine from the same arm in Pinocchio."""
    arm, data = model.pin_model, model.pin_model.createData()
    worst = np.zeros(3)
    for q, dq, tau in random_states(model):
        engine.reset(q, dq)
        engine.advance(tau)
        ddq = (engine.dq - dq) / STEP  # both are semi-implicit: a step's speed is that of its first acceleration
        exact = pin.aba(arm, data, q, dq, tau).copy()
        needed = pin.rnea(arm, data, q, dq, ddq)
        own = (share(engine.mass_matrix(q), model.mass_matrix(q)), share(ddq, exact), share(needed, tau))
        worst = np.maximum(worst, own)
    return Difference(*worst.tolist())


def share(value: FloatArray, exact: FloatArray) -> float:
    """Return the relative difference of an array from another one, by their norms."""
    return float(np.linalg.norm(value - exact) / np.linalg.norm(exact))
