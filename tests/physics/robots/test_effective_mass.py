"""Mass of the tip in each direction, against Khatib's inequality and closed forms."""

from itertools import pairwise

import numpy as np
import pytest

from runner.robots.task_space import mass_along, tip_mobility

ARMS = ["combined", "macro_mini_mini"]
# A folded Mini has its masses on its first axis; a rotor keeps that joint's inertia from being none.
ROTORS = {
    "combined": ("robot.stages.macro.armature=1e-7", "robot.stages.mini.armature=1e-7"),
    "macro_mini_mini": tuple(f"robot.stages.{stage}.armature=1e-7" for stage in ("macro", "mini", "mini2")),
}


@pytest.mark.parametrize("name", ARMS)
def test_each_stage_more_yields_more(checked_config, name):
    """Khatib's inequality, in 2,000 postures: of no direction does a stage take mobility away."""
    robot = checked_config(f"robot={name}", *ROTORS[name]).arm
    draw, least = np.random.default_rng(0), np.inf
    for _ in range(2_000):
        q = draw.uniform(-np.pi, np.pi, robot.model.nq)
        yields = [tip_mobility(robot.model, q, stage.joints.start) for stage in robot.stages]
        for inner, outer in pairwise(yields):
            more = inner - outer
            least = min(least, np.linalg.eigvalsh(0.5 * (more + more.T))[0] / np.trace(inner))
    assert least > -1e-12


def test_at_home_a_stage_is_as_heavy_as_its_last_rider(checked_config):
    expected = {"macro": [1.0, 2.0, 2.0], "combined": [0.1, 0.2, 0.2], "macro_mini_mini": [0.01, 0.02, 0.02]}
    for name, masses in expected.items():
        robot = checked_config(f"robot={name}").arm
        for stage in robot.stages:
            own = 1.0 / np.linalg.eigvalsh(tip_mobility(robot.model, robot.home, stage.joints.start))
            if stage is robot.stages[-1]:
                np.testing.assert_allclose(np.sort(own), masses, rtol=1e-9)
            assert own.max() <= max(masses) * (1.0 + 1e-9)


def test_a_rider_alone_is_the_arm_on_its_own_base_turned(checked_config):
    """R Lambda_own^-1 R^T of the Mini on a fixed base."""
    robot = checked_config("robot=combined").arm
    q = np.array([0.3, 0.4, -0.5, 0.2, 0.7, -0.9])
    mini = robot.stages[1]
    J, M = mini.model.tip_jacobian(q[3:])[:3], mini.model.mass_matrix(q[3:])
    R = robot.model.with_tip(mini.base_frame).tip_pose(q)[:3, :3]
    np.testing.assert_allclose(tip_mobility(robot.model, q, 3), R @ J @ np.linalg.solve(M, J.T) @ R.T, rtol=1e-9)


def test_the_mass_along_a_direction_is_what_a_force_there_meets(checked_config):
    robot = checked_config("robot=macro").arm
    q, n = np.array([0.3, 0.4, -0.5]), np.array([0.0, 0.6, 0.8])
    J, M = robot.model.tip_jacobian(q)[:3], robot.model.mass_matrix(q)
    acceleration = n @ J @ np.linalg.solve(M, J.T @ n)
    assert mass_along(tip_mobility(robot.model, q), n) == pytest.approx(1.0 / acceleration, rel=1e-12)
