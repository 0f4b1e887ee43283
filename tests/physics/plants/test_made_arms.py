"""Arms written in equivalent ways are one arm on every engine: mass matrix, bias torque, tip and trace.

PyBullet returns the tip's position in single precision, so its Jacobian stands for it there.
"""

import mujoco
import numpy as np
import pytest
from support.made_arms import Writer, make_arm

from runner.assembly.validation import validate
from runner.base.engines import has_pybullet
from runner.config.compose.compose import compose
from runner.plants.mujoco import Mujoco
from runner.robots.description import read_urdf
from runner.robots.model import RobotModel
from runner.simulation.run import simulate_repetition

WAYS = 20
ALIKE = 1e-10
LEAST = 1e-12  # of MuJoCo's moving links, as in conf/plant/mujoco.yaml


def in_pinocchio(urdf, q, dq):
    model = RobotModel(urdf, "tip")
    bias = model.coriolis_torque(q, dq) + model.gravity_torque(q)
    return model.mass_matrix(q), bias, model.tip_jacobian(q)[:3], model.tip_position(q)


def in_mujoco(urdf, q, dq):
    plant = Mujoco(urdf, RobotModel(urdf, "tip"), 1e-3, 1, "euler", LEAST)
    model, data = plant._model, mujoco.MjData(plant._model)
    data.qpos[:], data.qvel[:] = q, dq
    mujoco.mj_forward(model, data)
    tip, J = data.body("tip"), np.empty((3, model.nv))
    mujoco.mj_jac(model, data, J, None, tip.xpos, tip.id)
    return plant.mass_matrix(q), data.qfrc_bias.copy(), J, tip.xpos.copy()


def in_bullet(urdf, q, dq):
    import pybullet

    from runner.plants.bullet_engine import Bullet

    model = RobotModel(urdf, "tip")
    plant = Bullet(urdf, model, 1e-3, 1)
    body, client, joints = plant._body, plant._client, plant._joints
    plant.reset(q, dq)
    order = np.argsort(joints)  # Bullet uses its own order of joints
    bias = np.empty(model.nq)
    state = [values[order].tolist() for values in (q, dq, np.zeros(model.nq))]
    bias[order] = pybullet.calculateInverseDynamics(body, *state, physicsClientId=client)
    tip = plant._joint_indices()["end"]
    J = np.empty((3, model.nq))
    J[:, order] = pybullet.calculateJacobian(body, tip, [0.0, 0.0, 0.0], *state, physicsClientId=client)[0]
    M = plant.mass_matrix(q)
    plant.close()
    return M, bias, J


ENGINES = [in_pinocchio, in_mujoco, *([in_bullet] if has_pybullet() else [])]


def disagreement(seed, path, ways=WAYS):
    """The largest relative difference of an arm's mass matrix, bias and tip from the plain way, by engine."""
    generator = np.random.default_rng(seed)
    arm = make_arm(generator)
    lower, upper = np.array([joint.limits for joint in arm.joints]).T
    q, dq = 0.9 * generator.uniform(lower, upper), generator.uniform(-1.0, 1.0, len(lower))
    path.write_text(Writer(generator, plain=True).write(arm))
    plain, worst = in_pinocchio(read_urdf(path, {}), q, dq), dict.fromkeys(ENGINES, 0.0)
    for _ in range(ways):
        writer = Writer(generator)
        path.write_text(writer.write(arm))
        urdf, signs = read_urdf(path, {}), np.array(writer.signs)
        for engine in ENGINES:
            M, bias, J, *tip = engine(urdf, signs * q, signs * dq)
            pairs = zip((np.outer(signs, signs) * M, signs * bias, signs * J, *tip), plain, strict=False)
            apart = [np.abs(one - other).max() / np.abs(other).max() for one, other in pairs]
            worst[engine] = max(worst[engine], *apart)
    return {engine.__name__: off for engine, off in worst.items()}


def differing(path, seeds, ways):
    """The arms, by seed, that are not the same on every engine, with their largest differences."""
    found = {seed: disagreement(seed, path, ways) for seed in seeds}
    return {seed: worst for seed, worst in found.items() if max(worst.values()) >= ALIKE}


@pytest.mark.costs(6)
def test_arms_written_otherwise_are_the_same_arms(tmp_path):
    assert differing(tmp_path / "arm.urdf", range(20), 4) == {}


@pytest.mark.slow
@pytest.mark.parametrize("part", range(10))
def test_200_arms_written_in_20_ways_are_the_same_arms(tmp_path, part):
    assert differing(tmp_path / "arm.urdf", range(100 + 20 * part, 120 + 20 * part), WAYS) == {}


CONFIG = """# @package _global_
# A made-up arm
defaults:
  - override /controller: computed_torque
  - override /trajectory: joint_quintic
robot:
  name: made
  urdf: made.urdf
  tip: tip
  home: {home}
  goal: [0.0, 0.0, 0.0]
trajectory:
  goal_configuration: {goal}
  duration: 1.0
duration: 2.0
"""


def traces(folder, seed, writer, plant):
    """Positions and tip of a run of an arm; positions have the signs of the plain way."""
    arm = make_arm(np.random.default_rng(seed))
    (folder / "robots").mkdir(parents=True, exist_ok=True)
    (folder / "robot").mkdir(exist_ok=True)
    (folder / "robots" / "made.urdf").write_text(writer.write(arm))
    signs = np.array(writer.signs)
    lower, upper = np.array([joint.limits for joint in arm.joints]).T
    home, goal = (signs * (lower + part * (upper - lower)) for part in (0.45, 0.6))
    (folder / "robot" / "made.yaml").write_text(CONFIG.format(home=home.tolist(), goal=goal.tolist()))
    trace = simulate_repetition(validate(compose(["robot=made", f"plant={plant}"], [folder])), 0)
    assert trace.failure is None
    return signs * trace.q, trace.tip


def parted(folder, seed, plant):
    """The largest difference between the motions of an arm written plainly and otherwise, in m and rad."""
    generator = np.random.default_rng(seed)
    plain, other = (
        traces(folder / name, seed, Writer(generator, name == "plain"), plant) for name in ("plain", "other")
    )
    assert np.ptp(plain[1], axis=0).max() > 0.01
    return max(float(np.abs(one - two).max()) for one, two in zip(plain, other, strict=True))


PLANTS = ["rk4", "mujoco", pytest.param("bullet", marks=pytest.mark.bullet)]


@pytest.mark.costs(3)
@pytest.mark.parametrize("plant", PLANTS)
def test_an_arm_written_otherwise_moves_alike(tmp_path, plant):
    assert parted(tmp_path, 3, plant) < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("part", range(10))
@pytest.mark.parametrize("plant", PLANTS)
def test_200_arms_written_otherwise_move_alike(tmp_path, plant, part):
    seeds = range(100 + 20 * part, 120 + 20 * part)
    found = {seed: parted(tmp_path / str(seed), seed, plant) for seed in seeds}
    assert {seed: off for seed, off in found.items() if off >= 1e-10} == {}
