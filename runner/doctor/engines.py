"""PyBullet, MuJoCo and Pinocchio on the same arm."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from runner.doctor.finding import Finding
from runner.engines import has_pybullet
from runner.errors import ConfigError
from runner.plants.mujoco import Mujoco
from runner.robots.model import FloatArray, RobotModel, joint_names_of

if TYPE_CHECKING:
    from runner.plants.bullet import Bullet

_SAMPLES = 1000
_STEP = 1e-4  # s
_AGREE = 1e-6  # of the largest entry: beyond it the engines simulate different arms
_LEAST = 1e-12  # kg and kg m^2, of MuJoCo's moving links, as in conf/plant/mujoco.yaml
_DIFFERENT = 0.01  # of the largest moment


@dataclass(frozen=True)
class _State:
    """A state of the arm with torques, and what Pinocchio says of it.

    Attributes:
        q, dq, tau: Joint positions, velocities and torques, shapes (nq,).
        M: The mass matrix, shape (nq, nq).
        asked: The accelerations to which the torques lead, shape (nq,).
    """

    q: FloatArray
    dq: FloatArray
    tau: FloatArray
    M: FloatArray
    asked: FloatArray


def compare_engines(urdf: str, model: RobotModel, generator: np.random.Generator) -> list[Finding]:
    """Return the largest disagreement of mass matrix and forward dynamics at random states within the joints' limits.

    Those of PyBullet and MuJoCo are compared with Pinocchio's; their accelerations are those of one step of their own.
    Where PyBullet is not installed a note says so.
    """
    states = _random_states(model, generator)
    mujoco = _compare("MuJoCo", lambda: Mujoco(urdf, model, _STEP, 1, "euler", _LEAST), states, _added_by_mujoco(model))
    if not has_pybullet():
        return [Finding("note", "engines", "PyBullet is not installed: not compared with Pinocchio"), *mujoco]
    from runner.plants.bullet import Bullet

    return [*_compare("PyBullet", lambda: Bullet(urdf, model, _STEP, 1), states, 0.0), *mujoco]


def _random_states(model: RobotModel, generator: np.random.Generator) -> list[_State]:
    lower, upper = model.usual_range
    middle, half = 0.5 * (lower + upper), 0.45 * (upper - lower)  # away from the stops, which engines have
    states = []
    for _ in range(_SAMPLES):
        q = middle + half * generator.uniform(-1.0, 1.0, model.nq)
        dq, asked = generator.uniform(-1.0, 1.0, (2, model.nq))
        M = model.mass_matrix(q)
        states.append(_State(q, dq, model.gravity_torque(q) + model.coriolis_torque(q, dq) + M @ asked, M, asked))
    return states


def _added_by_mujoco(model: RobotModel) -> float:
    """Return the most by which MuJoCo's least mass and inertia of each moving link change a mass matrix, in kg m^2."""
    return model.nq * _LEAST * (1.0 + model.reach**2)


def _compare(name: str, make: "Callable[[], Bullet | Mujoco]", states: Sequence[_State], added: float) -> list[Finding]:
    """Compare an engine with Pinocchio; `added` is what it adds to the mass matrix, in kg m^2."""
    try:
        plant = make()
    except ConfigError as error:
        return [Finding("refused", "engines", problem.removeprefix("robot.urdf: ")) for problem in error.problems]
    largest, beyond = np.zeros(2), False
    try:
        for state in states:
            plant.reset(state.q, state.dq)
            mass = plant.mass_matrix(state.q)
            plant.advance(state.tau)
            accelerations = (plant.dq - state.dq) / _STEP
            off = np.array([np.abs(mass - state.M).max() / np.abs(state.M).max(),
                            np.abs(accelerations - state.asked).max() / np.abs(state.asked).max()])  # fmt: skip
            allowed = np.array([added / np.abs(state.M).max(), added / np.linalg.eigvalsh(state.M)[0]])
            largest, beyond = np.maximum(largest, off), beyond or not np.all(off < _AGREE + allowed)
    finally:
        plant.close()
    text = (
        f"at {len(states)} random states the mass matrices of {name} and Pinocchio differ by {largest[0]:.1e} of their "
        f"largest entry, the accelerations by {largest[1]:.1e}"
    )
    if added:
        text += f"; {name} gives a moving link {_LEAST:g} kg and kg m^2 where it has less"
    if not beyond:
        return [Finding("note", "engines", text)]
    return [Finding("finding", "engines", text, "look at the links above: all engines must read the same arm")]


def compare_readings(urdf: Path) -> list[Finding]:
    """Return where PyBullet, when nothing is said to it, reads a file otherwise than it is written, or than Pinocchio.

    That is the names and the order of the joints, and inertia that it makes from the links' shapes; nothing where
    PyBullet is not installed.
    """
    if not has_pybullet():
        return []
    from runner.plants.bullet_reading import read_as_bullet

    try:
        said, made = read_as_bullet(urdf, True), read_as_bullet(urdf, False)
        names = joint_names_of(urdf.read_text(encoding="utf-8"))
    except ConfigError as error:
        text = f"the file cannot be loaded as it is: {'; '.join(error.problems)}"
        return [Finding("finding", "loading", text, "mend what stands above; break lines of 1,000 characters", True)]
    findings = []
    if names != said.joints:
        text = f"PyBullet lists the joints as {', '.join(said.joints)}, Pinocchio as {', '.join(names)}"
        findings.append(Finding("note", "names", text, "the runner goes by name"))
    off = {
        name: max(abs(a - b) for a, b in zip(link.moments, made.links[name].moments, strict=True)) / link.moments[-1]
        for name, link in said.links.items()
        if link.mass and link.moments[-1] > 0.0
    }
    off = {name: ratio for name, ratio in off.items() if ratio > _DIFFERENT}
    if off:
        worst = max(off, key=lambda name: off[name])
        text = (
            f"PyBullet makes the inertia of {len(off)} links from their shapes unless it is told not to; that of "
            f"'{worst}' is then off by {100.0 * off[worst]:.0f} %"
        )
        findings.append(
            Finding(
                "note", "inertia from shapes", text, "none needed: the runner makes PyBullet take the file's inertia"
            )
        )
    findings += [Finding("note", "PyBullet", f"it prints while it loads the file: {line}") for line in said.said[:10]]
    text = "PyBullet damps bodies by 0.04 1/s of their speed unless it is told not to"
    return [*findings, Finding("note", "default damping", text, "none needed: the runner sets it to zero")]
