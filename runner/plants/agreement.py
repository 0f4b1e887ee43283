"""Agreement of engines on an arm: PyBullet and MuJoCo with Pinocchio, and the compiled step with PyBullet."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.compiled_bullet import CompiledBullet
from runner.robots.model import RobotModel
from runner.symbolic.bullet_step import BulletArm

if TYPE_CHECKING:
    from runner.plants.bullet_engine import Bullet
    from runner.plants.mujoco import Mujoco

ENGINES = {"bullet": "PyBullet", "mujoco": "MuJoCo"}
"""Engines with a reader of robot files, by the kind of their plant."""
_STEP = 1e-4  # s
_AGREE = 1e-6  # of the largest torque: beyond it the engines simulate different arms
_LEAST = 1e-12  # kg and kg m^2, of MuJoCo's moving links, as in conf/plant/mujoco.yaml
_DISTANCE = 1e-2  # rad or m from a stop, on both sides; at most a hundredth of the range
_OUTWARDS = 0.1  # rad/s or m/s, there
_STOPPED = 1.0  # rad/s^2 or m/s^2: least acceleration of a stop, which without it is zero
_SPEED = 1.0  # rad/s or m/s: change of speed in one of its ticks by the random torques, at most
_SAME = 1e-6  # of axes, origins in m, and moments of inertia


class Agreement(NamedTuple):
    """Result of a comparison.

    Attributes:
        off: Largest missing torque, as a fraction of the largest torque.
        difference: Message about the joint or link that differs first; empty if the engine simulates the same arm.
    """

    off: float
    difference: str


def compare(kind: str, urdf: str, model: RobotModel, samples: int, generator: np.random.Generator) -> Agreement:
    """Compare the motion of an engine with that of Pinocchio.

    The acceleration of one step under random torques is compared, because an engine may have a right mass matrix and a
    wrong step. Each finite position limit must stop its joint there and not before; random states do not show that.

    Args:
        kind: Kind of the engine's plant; see ENGINES.
        urdf: Canonical text of the arm.
        model: Model of this text, whose mass matrix is regular.
        samples: Number of random states within the joint limits.
        generator: Generator of the states.

    Raises:
        ConfigError: if the engine cannot load the text.
    """
    plant = _make(kind, urdf, model)
    try:
        off = max(_off(plant, model, *_random_state(model, generator)) for _ in range(samples))
        if off < _AGREE:
            return Agreement(off, next(_wrong_stops(kind, plant, model), ""))
        return Agreement(off, _first_difference(ENGINES[kind], plant, model))
    finally:
        plant.close()


def has_bits_of_bullet(
    urdf: str, model: RobotModel, arm: BulletArm, ticks: int, generator: np.random.Generator
) -> bool:
    """Return True if the compiled step of an arm has the bits of PyBullet under random torques; -0 is equal to 0.

    Half of the ticks begin with a reset of PyBullet to the state of the step, as in a hand-over. Where a joint reaches
    a limit, both start from another state.

    Args:
        urdf: Canonical text of the arm.
        model: Model of the arm.
        arm: The arm as Bullet has it.
        ticks: Number of ticks.
        generator: Generator of states and torques.

    Raises:
        ConfigError: if PyBullet cannot load the text.
    """
    from runner.plants.bullet_engine import Bullet

    step = 10.0 * _STEP
    code, plant, n = CompiledBullet(model, arm, step), Bullet(urdf, model, step, 1), model.nq
    try:
        state = np.concatenate(_random_state(model, generator)[:2])
        plant.reset(state[:n], state[n:])
        for tick in range(ticks):
            if tick == ticks // 2:
                plant.set_gravity(gravity := generator.uniform(-10.0, 10.0, 3))
                code.set_gravity(gravity)
            q, dq = state[:n], state[n:]
            pushed = generator.uniform(-1.0, 1.0, n) * _SPEED / step - dq / (10.0 * step)
            tau = model.gravity_torque(q) + np.diagonal(model.mass_matrix(q)) * pushed
            if not code.advance(state, tau, 1):
                state[:] = np.concatenate(_random_state(model, generator)[:2])
                plant.reset(state[:n], state[n:])
                continue
            plant.advance(tau)
            if not (np.array_equal(plant.q, state[:n]) and np.array_equal(plant.dq, state[n:])):
                return False
            if tick >= ticks // 2:
                plant.reset(state[:n], state[n:])
        return True
    finally:
        plant.close()


def _make(kind: str, urdf: str, model: RobotModel) -> "Bullet | Mujoco":
    if kind == "bullet":
        from runner.plants.bullet_engine import Bullet

        return Bullet(f"{urdf}\n", model, _STEP, 1)  # another text than that of a run, which would reuse the server
    from runner.plants.mujoco import Mujoco

    return Mujoco(urdf, model, _STEP, 1, "euler", _LEAST)


def _random_state(model: RobotModel, generator: np.random.Generator) -> FloatArray:
    """Return positions away from the stops, velocities and accelerations, shape (3, nq)."""
    lower, upper = model.usual_range
    q = 0.5 * (lower + upper) + 0.45 * (upper - lower) * generator.uniform(-1.0, 1.0, model.nq)
    return np.array([q, *generator.uniform(-1.0, 1.0, (2, model.nq))])


def _off(plant: "Bullet | Mujoco", model: RobotModel, q: FloatArray, dq: FloatArray, asked: FloatArray) -> float:
    """Return the torque missing in an engine's step from a state, as a fraction of the largest one."""
    missing, largest = _missing_torque(plant, model, q, dq, asked)
    return float(np.abs(missing).max() / largest)


def _missing_torque(
    plant: "Bullet | Mujoco", model: RobotModel, q: FloatArray, dq: FloatArray, asked: FloatArray
) -> tuple[FloatArray, float]:
    M: FloatArray = model.mass_matrix(q)
    tau = model.gravity_torque(q) + model.coriolis_torque(q, dq) + M @ asked
    plant.reset(q, dq)
    plant.advance(tau)
    return M @ ((plant.dq - dq) / _STEP - asked), float(np.abs(tau).max())


def _wrong_stops(kind: str, plant: "Bullet | Mujoco", model: RobotModel) -> Iterator[str]:
    """Yield a message about each position limit at which an engine does not stop the joint, or before which it does."""
    limits = model.position_limits
    for joint, name in enumerate(model.joint_names):
        distance = min(_DISTANCE, 0.01 * float(limits[1, joint] - limits[0, joint]))
        for sign, limit in ((-1.0, limits[0, joint]), (1.0, limits[1, joint])):
            if np.isfinite(limit) and distance > 0.0:
                before, beyond = (
                    -sign * _acceleration(plant, model, joint, limit + sign * place, sign) > _STOPPED
                    for place in (-distance, distance)
                )
                if before or not beyond:
                    said = "stops before" if before else "does not stop at"
                    yield f"joint '{name}' {said} its limit of {limit:g} {model.joint_units[joint]} in {ENGINES[kind]}"


def _acceleration(plant: "Bullet | Mujoco", model: RobotModel, joint: int, position: float, outwards: float) -> float:
    """Return the acceleration of a joint that moves outwards without a net torque, in rad/s^2 or m/s^2."""
    q, dq, rest = model.usual_range.mean(axis=0), np.zeros(model.nq), np.zeros(model.nq)
    q[joint], dq[joint] = position, outwards * _OUTWARDS
    _missing_torque(plant, model, q, dq, rest)
    return float(plant.dq[joint] - dq[joint]) / _STEP


def _first_difference(engine: str, plant: "Bullet | Mujoco", model: RobotModel) -> str:
    """Return a message about the first joint with another axis or origin, or the last link with another inertia."""
    zero = np.zeros(model.nq)
    ours, theirs = model.joint_axes(zero), plant.joint_axes(zero)
    for name, own, other in zip(model.joint_names, ours, theirs, strict=True):
        if np.abs(own - other).max() > _SAME:
            return f"joint '{name}' has {_axis(other)} in {engine} and {_axis(own)} in Pinocchio, at q = 0"
    for joint in reversed(range(model.nq)):
        own, other = model.mass_matrix(zero)[joint, joint], plant.mass_matrix(zero)[joint, joint]
        if abs(own - other) > _SAME * own:
            unit = "kg" if model.prismatic[joint] else "kg m^2"
            place = f"link '{model.link_names[joint]}' and what it carries"
            return f"{place} have {other:.6g} {unit} for their joint in {engine} and {own:.6g} in Pinocchio"
    missing, _ = _missing_torque(plant, model, zero, zero, np.ones(model.nq))
    return f"joint '{model.joint_names[int(np.abs(missing).argmax())]}' accelerates differently at q = 0"


def _axis(found: FloatArray) -> str:
    axis, origin = (" ".join(f"{value:.4g}" for value in part + 0.0) for part in np.split(found, 2))
    return f"the axis {axis} at {origin} m"
