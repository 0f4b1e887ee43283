"""Links without mass and names used twice: mass matrices and motion of PyBullet and MuJoCo against Pinocchio."""

import re

import numpy as np
import pytest

from runner.plants.mujoco import Mujoco
from runner.robots.description import read_urdf
from runner.robots.model import RobotModel

HEAVY, TURNS, NOTHING = (2.0, 0.02), (0.0, 0.1), (0.0, 0.0)
ARMS = {
    "inertia at the root": (TURNS, HEAVY, HEAVY, HEAVY, NOTHING),
    "inertia on the way": (HEAVY, HEAVY, TURNS, HEAVY, NOTHING),
    "inertia on the last link": (HEAVY, HEAVY, HEAVY, TURNS, NOTHING),
    "inertia at the tip": (HEAVY, HEAVY, HEAVY, HEAVY, TURNS),
    "frames at both ends": (None, HEAVY, HEAVY, HEAVY, None),
}
"""Mass and inertia of the links base, a, b, c and tip; None has no <inertial>."""
LEAST = 1e-12  # kg and kg m^2, of a moving link in MuJoCo


def link(name, inertial):
    if inertial is None:
        return f'<link name="{name}"/>'
    m, i = inertial
    tensor = f'<inertia ixx="{i}" iyy="{i}" izz="{1.5 * i}" ixy="0" ixz="{0.1 * i}" iyz="0"/>'
    return f'<link name="{name}"><inertial><origin xyz="0.02 0 0.1"/><mass value="{m}"/>{tensor}</inertial></link>'


def written(path, inertials, names=("q1", "q2", "q3", "end"), robot=' name="arm"'):
    links = ("base", "a", "b", "c", "tip")
    joints = "".join(
        f'<joint name="{name}" type="{"fixed" if child == "tip" else "revolute"}"><parent link="{parent}"/>'
        f'<child link="{child}"/><origin xyz="0.05 0 0.3"/><axis xyz="{axis}"/>'
        '<limit lower="-2" upper="2" effort="99" velocity="9"/></joint>'
        for name, parent, child, axis in zip(
            names, links, links[1:], ("0 0 1", "0 1 0", "0 1 0", "1 0 0"), strict=False
        )
    )
    path.write_text(f"<robot{robot}>{''.join(map(link, links, inertials))}{joints}</robot>")
    return path


def off(plant, model):
    """Largest differences of an engine's mass matrix, and of M times its accelerations, from Pinocchio's."""
    generator, worst = np.random.default_rng(0), np.zeros(2)
    for _ in range(10):
        q, dq, asked = generator.uniform(-1.0, 1.0, (3, model.nq))
        M = model.mass_matrix(q)
        tau = model.gravity_torque(q) + model.coriolis_torque(q, dq) + M @ asked
        plant.reset(q, dq)
        mass = plant.mass_matrix(q)
        plant.advance(tau)
        torque = np.abs(M @ ((plant.dq - dq) / 1e-4 - asked)).max()
        worst = np.maximum(worst, [np.abs(mass - M).max() / np.abs(M).max(), torque / np.abs(tau).max()])
    plant.close()
    return worst


@pytest.mark.bullet
@pytest.mark.parametrize("arm", ARMS)
def test_bullet_reads_them_as_they_are_written(tmp_path, arm):
    from runner.plants.bullet_engine import Bullet

    urdf = read_urdf(written(tmp_path / "arm.urdf", ARMS[arm]), {})
    model = RobotModel(urdf, "tip")
    assert np.all(off(Bullet(urdf, model, 1e-4, 1), model) < [1e-14, 1e-11])


@pytest.mark.parametrize("arm", ARMS)
def test_mujoco_reads_them_as_they_are_written_up_to_its_least_inertia(tmp_path, arm):
    urdf = read_urdf(written(tmp_path / "arm.urdf", ARMS[arm]), {})
    model = RobotModel(urdf, "tip")
    added = LEAST * (1.0 + model.reach**2) if arm in ("inertia on the way", "inertia on the last link") else 0.0
    least = min(np.linalg.eigvalsh(model.mass_matrix(q))[0] for q in np.random.default_rng(0).uniform(-1, 1, (10, 3)))
    assert np.all(off(Mujoco(urdf, model, 1e-4, 1, "euler", LEAST), model) < np.array([1e-14, 1e-11]) + added / least)


def test_a_joint_with_the_name_of_a_link_gets_another(tmp_path):
    plain = read_urdf(written(tmp_path / "plain.urdf", ARMS["frames at both ends"]), {})
    urdf = read_urdf(written(tmp_path / "arm.urdf", ARMS["frames at both ends"], ("b", "c", "a", "tip"), robot=""), {})
    model, other = RobotModel(urdf, "tip"), RobotModel(plain, "tip")
    assert model.joint_names == ("b_joint", "c_joint", "a_joint")
    q = np.array([0.3, -0.5, 0.7])
    np.testing.assert_array_equal(model.tip_pose(q), other.tip_pose(q))
    np.testing.assert_array_equal(model.frame_poses(q, model.joint_names), other.frame_poses(q, other.joint_names))
    np.testing.assert_array_equal(model.frame_poses(q, ("a", "b")), other.frame_poses(q, ("a", "b")))


def test_a_shape_without_size_is_left_out(tmp_path):
    path = written(tmp_path / "arm.urdf", ARMS["frames at both ends"])
    shapes = (
        '<box size="0 0 0"/>',
        '<cylinder radius="0.1" length="0"/>',
        '<sphere radius="-1"/>',
        '<sphere radius="1"/>',
    )
    text = "".join(f"<collision><geometry>{shape}</geometry></collision>" for shape in shapes)
    path.write_text(path.read_text().replace('<link name="b">', f'<link name="b">{text}'))
    urdf = read_urdf(path, {})
    assert urdf.count("<collision>") == 1
    Mujoco(urdf, RobotModel(urdf, "tip"), 1e-4, 1, "euler", LEAST).close()


def test_a_rod_that_is_fixed_on_the_arm_is_taken_by_mujoco(tmp_path):
    arm = (HEAVY, HEAVY, HEAVY, HEAVY, (1.0, 0.05))
    path = written(tmp_path / "arm.urdf", arm)
    text, rod = path.read_text(), '<inertia ixx="0.05" iyy="0.05" izz="{}" ixy="0" ixz="0" iyz="0"/>'
    tip = text.index('<link name="tip">')
    for izz in ("0", "-1e-9", "1e-20"):  # by rounding below 0
        path.write_text(text[:tip] + re.sub("<inertia .*?/>", rod.format(izz), text[tip:], count=1))
        urdf = read_urdf(path, {})
        model = RobotModel(urdf, "tip")
        assert np.all(off(Mujoco(urdf, model, 1e-4, 1, "euler", LEAST), model) < [1e-8, 1e-8])
