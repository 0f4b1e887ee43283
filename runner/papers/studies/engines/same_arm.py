"""Equations of motion of one arm in three code bases, at random states."""

from functools import lru_cache

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.papers.study.measured import Measured
from runner.papers.study.results import Runs
from runner.plants.bullet_engine import Bullet
from runner.plants.compiled_motion import CompiledStep
from runner.plants.mujoco import Mujoco
from runner.plants.runge_kutta import runge_kutta
from runner.robots.model import RobotModel
from runner.store import Run

STEP = 1e-3  # s
State = tuple[FloatArray, FloatArray, FloatArray]
"""Positions, velocities and torques of the joints."""
_STATES, _SEED = 20, 0
_SPEED, _ACCELERATION = 1.0, 10.0  # of random states, per joint: rad/s or m/s, and per s
_TEXTBOOK = "open/planar/MuJoCo Euler/0.001"
_LENGTH, _MASS, _RADIUS = 1.0, 1.0, 0.03  # of each of its links, in m and kg


@lru_cache(maxsize=64)
def compared(run: Run) -> dict[str, float]:
    """Return one arm by all code bases: the largest differences over random states.

    Its number of `joints`; the largest `condition` number of its mass matrix; differences of `bullet` and `mujoco` from
    Pinocchio, see difference; and the `compiled` code's relative difference of the change of speed in a step.
    """
    model, bullet = run.model, bullet_of(run)
    try:
        engines = {"bullet": difference(model, bullet), "mujoco": difference(model, mujoco_of(run))}
    finally:
        bullet.close()
    states, compiled = random_states(model), CompiledStep(model, STEP)
    return {
        "joints": model.nq,
        "condition": max(float(np.linalg.cond(model.mass_matrix(q))) for q, _, _ in states),
        "compiled": max(_step_difference(model, compiled, *state) for state in states),
        **{f"{engine} {what}": off for engine, found in engines.items() for what, off in found.items()},
    }


def textbook(runs: Runs) -> Measured:
    """Return the largest relative difference of the engines' mass matrices of the two links from the textbook's."""
    run = runs[_TEXTBOOK]
    model, bullet, mujoco = run.model, bullet_of(run), mujoco_of(run)
    try:
        off = max(
            share(ours, _two_links(float(q[1])))
            for q, _, _ in random_states(model)
            for ours in (model.mass_matrix(q), bullet.mass_matrix(q), mujoco.mass_matrix(q))
        )
    finally:
        bullet.close()
    return Measured("largest difference from the textbook's mass matrix", off)


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


def difference(model: RobotModel, engine: Bullet | Mujoco) -> dict[str, float]:
    """Return the relative differences of an arm in an engine from the same arm in Pinocchio, the largest over states.

    Of the `mass` matrix, Frobenius norm; of the `acceleration` under given torques; and of the `torque` that Pinocchio
    says the engine's accelerations need.
    """
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
    return dict(zip(("mass", "acceleration", "torque"), worst.tolist(), strict=True))


def share(value: FloatArray, exact: FloatArray) -> float:
    """Return the relative difference of an array from another one, by their norms."""
    return float(np.linalg.norm(value - exact) / np.linalg.norm(exact))


def _two_links(elbow: float) -> FloatArray:
    """Return the textbook's mass matrix of two equal links, cylinders with the centre of mass in the middle."""
    inertia = _MASS * (3.0 * _RADIUS**2 + _LENGTH**2) / 12.0
    half, coupled = 0.5 * _LENGTH, 0.5 * _LENGTH**2 * np.cos(elbow)
    lower = inertia + _MASS * half**2
    return np.array(
        [
            [inertia + _MASS * half**2 + lower + _MASS * (_LENGTH**2 + 2.0 * coupled), lower + _MASS * coupled],
            [lower + _MASS * coupled, lower],
        ]
    )


def _step_difference(
    model: RobotModel, compiled: CompiledStep, q: FloatArray, dq: FloatArray, tau: FloatArray
) -> float:
    arm, data, n = model.pin_model, model.pin_model.createData(), model.nq
    state = np.concatenate([q, dq])
    exact = runge_kutta(lambda x: np.append(x[n:], pin.aba(arm, data, x[:n], x[n:], tau)), state, STEP, 1)
    compiled.advance(state, tau, 1)
    return share(state[n:] - dq, exact[n:] - dq)
