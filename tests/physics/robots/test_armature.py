"""Armature: the model and MuJoCo's own reading of an MJCF agree, closed forms, named sets, and what is refused."""

import mujoco
import numpy as np
import pytest
import yaml
from support.arms import checked, model_of, urdf_of
from support.mjcf_arms import written
from support.physics import assert_energy_kept

from runner.base.errors import ConfigError
from runner.plants.rk4 import Rk4
from runner.robots.description import read_urdf
from runner.robots.inertials import armature_file
from runner.robots.model import RobotModel

EFFORT_TO_INERTIA = 0.008  # s^2: N times 8e-5 kg m^2 for each N m of motor torque, with N = 100


def chain(generator, joints, armature):
    """An MJCF of made-up links, whose joints have armatures."""
    text = '<site name="tcp" pos="0.1 0.2 0.3"/>'
    for index in reversed(range(joints)):
        axis, place, centre = generator.uniform(-1.0, 1.0, (3, 3))
        moments = generator.uniform(0.02, 0.03, 3)
        kind = "slide" if index == 2 else "hinge"
        text = (
            f'<body pos="{place[0]} {place[1]} {place[2]}" euler="{axis[2]} 0.3 {axis[0]}">'
            f'<joint name="q{index}" type="{kind}" range="-1 1" axis="{axis[0]} {axis[1]} {axis[2]}" '
            f'armature="{float(armature[index])!r}"/>'
            f'<inertial pos="{centre[0]} {centre[1]} {centre[2]}" mass="{generator.uniform(0.5, 2.0)}" '
            f'diaginertia="{moments[0]} {moments[1]} {moments[2]}"/>{text}</body>'
        )
    return f'<mujoco model="chain"><compiler angle="radian"/><worldbody>{text}</worldbody></mujoco>'


@pytest.mark.parametrize("joints", [2, 3, 4, 6, 7])
def test_mass_matrix_gravity_and_tip_are_mujoco_s_on_the_original_file(tmp_path, joints):
    generator = np.random.default_rng(joints)
    armature = generator.uniform(0.01, 5.0, joints)
    path = written(tmp_path, chain(generator, joints, armature))
    theirs, ours = mujoco.MjModel.from_xml_path(str(path)), RobotModel(read_urdf(path, {}, armature.tolist()), "tcp")
    theirs.opt.gravity[:] = 0.0, 0.0, -9.81
    data, M, bias = mujoco.MjData(theirs), np.zeros((joints, joints)), np.zeros(joints)
    for _ in range(20):
        data.qpos[:], data.qvel[:] = generator.uniform(-1.0, 1.0, joints), 0.0
        mujoco.mj_forward(theirs, data)
        mujoco.mj_rne(theirs, data, 0, bias)
        mujoco.mj_fullM(theirs, data, M)
        q, dq, tau = data.qpos.copy(), *generator.uniform(-2.0, 2.0, (2, joints))
        np.testing.assert_allclose(ours.mass_matrix(q), M, rtol=0, atol=1e-12 * np.abs(M).max())
        np.testing.assert_allclose(ours.gravity_torque(q), bias, rtol=0, atol=1e-12 * np.abs(bias).max())
        np.testing.assert_allclose(ours.tip_position(q), data.site("tcp").xpos, rtol=0, atol=1e-12)
        data.qvel[:], data.qfrc_applied[:] = dq, tau
        mujoco.mj_forward(theirs, data)
        left_over = M @ (ours.forward_dynamics(q, dq, tau) - data.qacc)
        forces = np.abs(np.concatenate([tau, data.qfrc_bias])).max()
        assert np.abs(left_over).max() < 1e-12 * forces


def test_it_stands_on_the_diagonal_of_the_mass_matrix_and_nowhere_else():
    plain, A = model_of("xarm7", "flange"), np.linspace(0.1, 0.7, 7)
    geared = plain.with_armature(A)
    for q, dq in np.random.default_rng(3).uniform(-2.0, 2.0, (6, 2, 7)):
        np.testing.assert_allclose(geared.mass_matrix(q) - plain.mass_matrix(q), np.diag(A), atol=1e-14)
        np.testing.assert_array_equal(geared.gravity_torque(q), plain.gravity_torque(q))
        np.testing.assert_allclose(geared.coriolis_torque(q, dq), plain.coriolis_torque(q, dq), atol=1e-12)
        more = geared.energy(q, dq) - plain.energy(q, dq)
        assert more == pytest.approx(0.5 * A @ dq**2, rel=1e-9)


def test_a_base_does_not_feel_the_motor_of_the_second_joint():
    """As would a disc of that inertia on the second link: then M11 and M12 grow, too."""
    plain = model_of("planar")
    M = plain.with_armature(np.array([0.0, 3.0])).mass_matrix(np.array([0.3, 0.8]))
    more = M - plain.mass_matrix(np.array([0.3, 0.8]))
    np.testing.assert_allclose(more, [[0.0, 0.0], [0.0, 3.0]], atol=1e-14)


def test_it_keeps_the_energy():
    model = model_of("macro").with_armature(np.full(3, 0.3))
    plant = Rk4(model, 1e-3, 10)
    plant.reset(np.array([0.3, 0.5, -0.4]), np.array([1.0, 0.5, -0.5]))
    start = model.energy(plant.q, plant.dq)
    for _ in range(200):
        plant.advance(np.zeros(3))
    assert_energy_kept([start, model.energy(plant.q, plant.dq)], 1e-8)
    assert np.abs(plant.q - [0.3, 0.5, -0.4]).max() > 0.3


@pytest.mark.parametrize("robot", ["xarm7", "meca500"])
def test_the_assumed_set_follows_the_stated_rule(robot):
    model = checked(f"robot={robot}", "robot.armature=assumed").arm.model
    np.testing.assert_allclose(model.armature, EFFORT_TO_INERTIA * model.effort_limits, rtol=1e-9)


def test_the_xarm7_s_mass_matrix_with_the_assumed_set():
    M = checked("robot=xarm7", "robot.armature=assumed").arm.model.mass_matrix(np.zeros(7))
    assert np.diag(M).round(3).tolist() == [0.531, 0.764, 0.361, 0.673, 0.251, 0.172, 0.160]


def test_one_value_is_one_for_each_joint_by_stage():
    one = checked("robot=combined", "robot.stages.macro.armature=0.3", "robot.stages.mini.armature=[1e-3,2e-3,0]").arm
    expected = [0.3, 0.3, 0.3, 1e-3, 2e-3, 0.0]
    assert one.model.armature.tolist() == expected
    assert [value for stage in one.stages for value in stage.model.armature] == expected
    assert RobotModel(one.urdf, one.model.tip_name).armature.tolist() == expected  # as a stored run is read


def test_what_a_file_says_of_its_own_is_not_taken_without_a_word(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(urdf_of("planar").replace("</joint>", '<dynamics damping="1" armature="0.5"/></joint>'))
    assert RobotModel(read_urdf(path, {}), "tip").armature.tolist() == [0.0, 0.0]
    assert RobotModel(read_urdf(path, {}, [0.1, 0.0]), "tip").armature.tolist() == [0.1, 0.0]


@pytest.mark.parametrize(
    ("value", "problem"),
    [
        ("assume", r"no set 'assume' \(did you mean assumed\?\); sets: assumed\. Allowed: a number of 0 or more"),
        ("[0.1,0.2]", r"2 values for 7 joints \(joint1, .*joint7\); found \[0\.1, 0\.2\]"),
        (
            "-1.0",
            r"must be a number of 0 or more, a list of such with one for each joint, or the name of a set; found -1",
        ),
        ("[0.1,-0.2,0,0,0,0,0]", "must be a number of 0 or more, a list"),
        ("null", "must be a number of 0 or more, a list"),
    ],
    ids=["set", "few", "negative", "one negative", "null"],
)
def test_what_is_no_armature_is_refused(value, problem):
    with pytest.raises(ConfigError, match=rf"robot.armature: {problem}"):
        checked("robot=xarm7", f"robot.armature={value}")


def test_an_arm_without_sets_says_so():
    with pytest.raises(ConfigError, match=r"no set 'assumed'; there is no macro.armature.yaml"):
        checked("robot=macro", "robot.armature=assumed")


def test_a_set_of_one_s_own(tmp_path, macro_urdf):
    path = tmp_path / "arm.urdf"
    path.write_text(macro_urdf)
    armature_file(path).write_text(yaml.safe_dump({"mine": {"source": "me", "joints": {"q9": 0.1}}}))
    with pytest.raises(ConfigError, match=r"set 'mine' names the joint 'q9': no such joint.*; joints: "):
        read_urdf(path, {}, "mine")
    armature_file(path).write_text("mine: {source: me, joints: {q1: -1}}")
    with pytest.raises(ConfigError, match=r"arm.armature.yaml: mine.joints.q1: .*; found -1"):
        read_urdf(path, {}, "mine")
    armature_file(path).write_text("mine: [")
    with pytest.raises(ConfigError, match=r"arm.armature.yaml cannot be read"):
        read_urdf(path, {}, "mine")


def test_a_quantity_with_its_unit_is_a_number():
    assert (
        checked("robot=xarm7", "robot.armature='0.1kg m^2'").arm.urdf
        == checked("robot=xarm7", "robot.armature=0.1").arm.urdf
    )
