"""Equations of motion of one arm in three code bases, at random states."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.plants.compiled_motion import CompiledStep
from runner.robots.model import RobotModel
from runner.store import Run
from runner.studies.engines.side_by_side import (
    STEP,
    Difference,
    bullet_of,
    difference,
    mujoco_of,
    random_states,
    share,
)
from runner.study.measured import Measured
from runner.study.results import Runs, found

_TEXTBOOK = "planar"
_LENGTH, _MASS, _RADIUS = 1.0, 1.0, 0.03  # of each of its links, in m and kg


@dataclass(frozen=True)
class Compared:
    """One arm by all code bases.

    Attributes:
        name: What it is called.
        joints: Number of its joints.
        condition: Largest condition number of its mass matrix.
        bullet: PyBullet from Pinocchio.
        mujoco: MuJoCo from Pinocchio.
        compiled: Change of speed in a Runge-Kutta step, relative difference of compiled code from Pinocchio.
    """

    name: str
    joints: int
    condition: float
    bullet: Difference
    mujoco: Difference
    compiled: float


def comparisons(runs: Runs, words: Mapping[str, str]) -> list[Compared]:
    """Return every arm that is moved by held torques, at random states, by all code bases; words name the arms."""
    return [_compare(words[one.levels["arm"]], one.run) for one in found(runs, "open/{arm}/MuJoCo Euler/0.001")]


def mass_rows(compared: list[Compared]) -> list[list[str]]:
    """Return joints, condition number and differences of the mass matrix, a row for each arm."""
    return [
        [c.name, str(c.joints), number(c.condition, 2), number(c.bullet.mass, 2), number(c.mujoco.mass, 2)]
        for c in compared
    ]


def motion_rows(compared: list[Compared]) -> list[list[str]]:
    """Return the differences of accelerations and torques, a row for each arm."""
    return [
        [
            c.name,
            *(number(each.acceleration, 2) for each in (c.bullet, c.mujoco)),
            number(c.compiled, 2),
            *(number(each.torque, 2) for each in (c.bullet, c.mujoco)),
        ]
        for c in compared
    ]


def worst(compared: list[Compared]) -> dict[str, Measured]:
    """Return the largest differences over all arms, as shares, and the largest condition number."""
    both = [each for c in compared for each in (c.bullet, c.mujoco)]
    return {
        "mass": Measured("largest difference of a mass matrix", max(each.mass for each in both)),
        "acceleration": Measured("largest difference of accelerations", max(each.acceleration for each in both)),
        "torque": Measured("largest difference of torques", max(each.torque for each in both)),
        "compiled": Measured("largest difference of compiled code", max(c.compiled for c in compared)),
        "condition": Measured("largest condition number", max(c.condition for c in compared)),
    }


def textbook(runs: Runs) -> Measured:
    """Return the largest relative difference of the engines' mass matrices of the two links from the textbook's."""
    run = runs[f"open/{_TEXTBOOK}/MuJoCo Euler/0.001"]
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


def _compare(name: str, run: Run) -> Compared:
    model, bullet = run.model, bullet_of(run)
    try:
        differences = difference(model, bullet), difference(model, mujoco_of(run))
    finally:
        bullet.close()
    states, compiled = random_states(model), CompiledStep(model, STEP)
    condition = max(float(np.linalg.cond(model.mass_matrix(q))) for q, _, _ in states)
    off = max(_step_difference(model, compiled, *state) for state in states)
    return Compared(name, model.nq, condition, *differences, off)


def _step_difference(
    model: RobotModel, compiled: CompiledStep, q: FloatArray, dq: FloatArray, tau: FloatArray
) -> float:
    arm, data, h = model.pin_model, model.pin_model.createData(), STEP

    def slope(q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        return v, pin.aba(arm, data, q, v, tau).copy()

    v1, a1 = slope(q, dq)
    v2, a2 = slope(q + 0.5 * h * v1, dq + 0.5 * h * a1)
    v3, a3 = slope(q + 0.5 * h * v2, dq + 0.5 * h * a2)
    _, a4 = slope(q + h * v3, dq + h * a3)
    state = np.concatenate([q, dq])
    compiled.advance(state, tau, 1)
    return share(state[len(q) :] - dq, h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4))
