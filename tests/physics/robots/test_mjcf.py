"""Arms read from MJCF against MuJoCo's own model of the same file."""

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.mjcf_arms import CHAIN, disagreement, own_model, written

from runner.base.errors import ConfigError
from runner.robots.description import read_arm, read_urdf
from runner.robots.joint_dynamics import dynamics_of
from runner.robots.mjcf import read_mjcf
from runner.robots.model import RobotModel

TURN = '<joint name="q2" axis="0 1 0"/>'
INERTIAL = '<inertial mass="1.3" pos="0.02 0.1 -0.03" fullinertia="0.03 0.02 0.025 0.002 -0.003 0.001"/>'
CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 0.2) for y in (0, 0.1) for z in (0, 0.3)) + "".join(
    f"f {face}\n" for face in ("1 2 4", "1 4 3", "5 7 8", "5 8 6", "1 5 6", "1 6 2", "3 4 8", "3 8 7", "1 3 7", "1 7 5",
                               "2 6 8", "2 8 4")
)  # fmt: skip

ARMS = {
    "inertias from shapes": CHAIN,
    "radians": CHAIN.replace('angle="degree"', 'angle="radian"').replace("170", "3"),
    "euler angles": CHAIN.replace('pos="0 0 0.3"', 'pos="0 0.01 0.3" euler="10 -20 35"'),
    "another order of angles": CHAIN.replace('angle="degree"', 'angle="degree" eulerseq="ZXY"').replace(
        'pos="0 0 0.3"', 'pos="0 0 0.3" euler="10 -20 35"'
    ),
    "gimbal lock": CHAIN.replace('pos="0 0 0.3"', 'pos="0 0 0.3" euler="30 90 0"'),
    "axis and angle": CHAIN.replace('pos="0.3 0 0"', 'pos="0.3 0 0" axisangle="1 2 3 40"'),
    "a quaternion": CHAIN.replace('pos="0.3 0 0"', 'pos="0.3 0 0" quat="1 -1 0.5 0.2"'),
    "two axes": CHAIN.replace('pos="0.3 0 0"', 'pos="0.3 0 0" xyaxes="1 1 0 0 1 1"'),
    "a full inertia": CHAIN.replace(TURN, TURN + INERTIAL),
    "a turned inertia": CHAIN.replace(
        TURN, f'{TURN}<inertial mass="1" pos="0 0.1 0" euler="20 0 40" diaginertia="0.03 0.02 0.02"/>'
    ),
    "inertia always from shapes": CHAIN.replace(
        TURN, TURN + INERTIAL
    ).replace('angle="degree"', 'angle="degree" inertiafromgeom="true"'),
    "shapes of some groups": CHAIN.replace(
        '<geom fromto="0 0 0 0.2 0 0"/>', '<geom fromto="0 0 0 0.2 0 0"/><geom group="4" size="0.3 0.4"/>'
    ).replace('angle="degree"', 'angle="degree" inertiagrouprange="0 3"'),
    "bounds": CHAIN.replace('angle="degree"', 'angle="degree" boundmass="2" boundinertia="0.02"'),
    "a joint off its body's origin": CHAIN.replace('name="q2"', 'name="q2" pos="0.03 -0.02 0.05"'),
    "a slanting axis": CHAIN.replace('name="q2" axis="0 1 0"', 'name="q2" axis="1 2 -3"'),
    "a reference": CHAIN.replace('name="q2"', 'name="q2" ref="25" pos="0.03 0 0.05"'),
    "joints of one body": CHAIN.replace(
        '<joint name="q2" axis="0 1 0"/>',
        '<joint name="q2" axis="0 1 0" pos="0.01 0 0"/><joint name="q2b" axis="1 0 0" pos="0 0.02 0.03" ref="10"/>'
        '<joint name="q2c" type="slide" axis="0 1 1" range="-0.4 0.4" ref="0.1" pos="0 0 0.2"/>',
    ),
    "a slide": CHAIN.replace('name="q2"', 'name="q2" type="slide" range="-0.4 0.4" ref="0.2"'),
    "fixed bodies": CHAIN.replace(
        '<site name="tcp" pos="0.2 0 0"/>',
        '<body name="flange" pos="0.2 0 0" euler="0 40 0"><geom size="0.05 0.1"/><body name="tool" pos="0 0 0.1">'
        '<geom size="0.03" type="sphere"/><site name="tcp" pos="0 0 0.1" euler="10 20 30"/></body></body>',
    ),
    "frames": CHAIN.replace('<body name="base"', '<frame pos="1 0 0" euler="0 0 20"><body name="base"').replace(
        "</worldbody>", "</frame></worldbody>"
    ),
    "classes": CHAIN.replace("<default>", '<default><default class="x"><joint axis="1 0 0" pos="0 0 0.1"/></default>')
    .replace('name="q3" axis="0 1 0"', 'name="q3" class="x"')
    .replace('<body name="hand"', '<body name="hand" childclass="x"'),
    "no limits": CHAIN.replace('<joint range="-170 170"/>', ""),
    "limits that are switched off": CHAIN.replace('range="-170 170"', 'range="-170 170" limited="false"'),
    "sheet shapes": CHAIN.replace('<geom fromto="0 0 0 0.2 0 0"/>', '<geom type="box" size="0.1 0.02 0.05" mass="2"/>'),
    "what is left out": CHAIN.replace(
        '<joint range="-170 170"/>', '<joint range="-170 170" damping="3" armature="0.2" frictionloss="0.5"/>'
    ).replace('angle="degree"/>', 'angle="degree"/><option gravity="0 1 -3" density="1.2" wind="1 0 0"/>'),
}  # fmt: skip


def test_the_arms_differ():
    assert len(set(ARMS.values())) == len(ARMS)


@pytest.mark.parametrize("name", ARMS)
def test_the_urdf_moves_as_mujocos_own_model(tmp_path, name):
    assert disagreement(written(tmp_path, ARMS[name]), "tcp") < 1e-10


def test_a_body_may_be_the_tip(tmp_path):
    text = ARMS["joints of one body"].replace('name="q3"', 'name="q3" pos="0.05 0 0"')
    assert disagreement(written(tmp_path, text), "hand") < 1e-10


def test_inertia_of_a_mesh(tmp_path):
    text = CHAIN.replace("<worldbody>", '<asset><mesh name="m" file="m.obj"/></asset><worldbody>', 1)
    text = text.replace('angle="degree"', 'angle="degree" meshdir="meshes"')
    text = text.replace('<geom fromto="0 0 0 0.2 0 0"/>', '<geom type="mesh" mesh="m"/>')
    mesh = written(tmp_path, CUBE, "meshes/m.obj")
    path = written(tmp_path, text)
    assert disagreement(path, "tcp") < 1e-10
    assert read_mjcf(path).files == (path, mesh)


def test_included_files_are_read_and_a_change_of_them_counts(tmp_path):
    text = '<mujocoinclude><joint name="q2" axis="{}"/></mujocoinclude>'
    part = written(tmp_path, text.format("1 0 0"), "parts/joint.xml")
    path = written(tmp_path, CHAIN.replace(TURN, '<include file="parts/joint.xml"/>'))
    assert disagreement(path, "tcp") < 1e-10
    assert read_mjcf(path).files == (path, part)
    part.write_text(text.format("0.6 0.8 0"))
    assert disagreement(path, "tcp") < 1e-10


numbers = st.floats(-1.0, 1.0, allow_nan=False).map(lambda value: round(value, 6))
vectors = st.tuples(numbers, numbers, numbers)
axes = vectors.filter(lambda axis: np.linalg.norm(axis) > 0.1)
joints = st.tuples(st.sampled_from(["hinge", "slide"]), axes, vectors, numbers)
bodies = st.tuples(vectors, st.tuples(axes, numbers), st.lists(joints, max_size=3), st.integers(1, 3))


def _as_text(values):
    return " ".join(map(str, values))


def _random_chain(parts):
    text, number = '<site name="tcp" pos="0.1 0.2 0.3" euler="10 20 30"/>', sum(len(part[2]) for part in parts)
    for place, (about, turn), on_body, shape in reversed(parts):
        inside = ""
        number -= len(on_body)
        for index, (kind, axis, beside, ref) in enumerate(on_body):
            ref = 40.0 * ref if kind == "hinge" else 0.2 * ref
            inside += (
                f'<joint name="j{number + index}" type="{kind}" axis="{_as_text(axis)}" pos="{_as_text(beside)}" '
                f'ref="{ref}" range="{"-170 170" if kind == "hinge" else "-1 1"}"/>'
            )
        size = (0.1 * shape, 0.15, 0.2)
        inside += f'<geom type="box" size="{_as_text(size)}" pos="{_as_text(place[::-1])}" euler="0 30 {40 * shape}"/>'
        text = f'<body pos="{_as_text(place)}" axisangle="{_as_text(about)} {180 * turn}">{inside}{text}</body>'
    return f'<mujoco><worldbody><body name="base">{text}</body></worldbody></mujoco>'


@settings(max_examples=20, deadline=None)
@given(st.lists(bodies, min_size=1, max_size=6).filter(lambda parts: any(part[2] for part in parts)))
def test_random_chains_move_as_mujocos_own_model(tmp_path_factory, parts):
    path = written(tmp_path_factory.mktemp("chain"), _random_chain(parts))
    assert disagreement(path, "tcp", samples=3) < 1e-10


def test_limits_are_mujocos(tmp_path):
    path = written(tmp_path, CHAIN.replace('name="q2"', 'name="q2" range="-30 60"'))
    model = RobotModel(read_urdf(path, {}), "tcp")
    np.testing.assert_allclose(np.array(model.position_limits).T, own_model(path).jnt_range, atol=1e-15)


def test_without_limits_there_are_none(tmp_path):
    model = RobotModel(read_urdf(written(tmp_path, ARMS["no limits"]), {}), "tcp")
    assert not np.isfinite(model.position_limits).any()
    assert not np.isfinite(model.effort_limits).any()
    assert not np.isfinite(model.velocity_limits).any()


@pytest.mark.parametrize(
    ("actuators", "joint", "efforts", "told"),
    [
        ('<motor joint="q1" ctrlrange="-2 2" gear="10"/>', "", (20, np.inf, np.inf), ""),
        ('<motor joint="q1" ctrlrange="-2 2" forcerange="-1.5 1.5" gear="-10"/>', "", (15, np.inf, np.inf), ""),
        ('<position joint="q2" kp="10" forcerange="-7 7" ctrlrange="-1 1"/>', "", (np.inf, 7, np.inf), "actuator0"),
        ('<motor joint="q2" ctrlrange="-7 5"/>', "", (np.inf, 5, np.inf), "'q2' from -7 to 5, of which 5 stands both"),
        ('<motor joint="q2" ctrlrange="-9 9"/>', ' actuatorfrcrange="-4 4"', (np.inf, 4, np.inf), ""),
        (2 * '<motor joint="q2" ctrlrange="-9 9"/>', "", 3 * (np.inf,), "the limits of the 2 actuators of joint 'q2'"),
        ('<motor site="tcp" ctrlrange="-9 9"/>', "", 3 * (np.inf,), "gains, dynamics and transmissions"),
    ],
)  # fmt: skip
def test_efforts_follow_from_actuators(tmp_path, actuators, joint, efforts, told):
    text = CHAIN.replace("</worldbody>", f"</worldbody><actuator>{actuators}</actuator>")
    path = written(tmp_path, text.replace('name="q2"', f'name="q2"{joint}'))
    assert RobotModel(read_urdf(path, {}), "tcp").effort_limits.tolist() == list(efforts)
    assert told in " ".join(read_mjcf(path).left_out.rest)


def test_a_site_of_a_bodys_name_gets_another(tmp_path):
    path = written(tmp_path, CHAIN.replace('name="tcp"', 'name="hand"'))
    assert "site 'hand' is the link 'hand_site', as another link has the name" in read_mjcf(path).left_out.rest
    model = RobotModel(read_urdf(path, {}), "hand_site")
    data = mujoco.MjData(own_model(path))
    mujoco.mj_kinematics(own_model(path), data)
    np.testing.assert_allclose(model.tip_position(np.zeros(3)), data.site("hand").xpos, atol=1e-12)


@pytest.mark.parametrize("link", ["hand", "tcp"])
def test_a_joint_of_a_links_name_gets_another(tmp_path, link):
    path = written(tmp_path, CHAIN.replace('name="q3"', f'name="{link}" pos="0.02 0 0.1"'))
    assert f"joint '{link}' is '{link}_joint', as a link has the name" in read_mjcf(path).left_out.rest
    model, data = RobotModel(read_urdf(path, {}), link), mujoco.MjData(own_model(path))
    data.qpos[:] = [0.3, 0.5, 0.7]
    mujoco.mj_kinematics(own_model(path), data)
    place = data.body(link).xpos if link == "hand" else data.site(link).xpos
    np.testing.assert_allclose(model.tip_position(data.qpos), place, atol=1e-12)


def test_masses_and_armature_change_it_as_a_urdf(tmp_path):
    path = written(tmp_path, CHAIN)
    model = RobotModel(read_urdf(path, {"hand": 5.0}, armature=0.1), "tcp")
    plain = RobotModel(read_urdf(path, {}), "tcp")
    assert model.mass > plain.mass + 1.0
    assert model.mass_matrix(np.zeros(3))[0, 0] > plain.mass_matrix(np.zeros(3))[0, 0] + 0.1
    with pytest.raises(ConfigError, match=r"robot\.masses.tcp: link 'tcp' is massless"):
        read_urdf(path, {"tcp": 1.0})


def test_mujocos_warnings_are_kept_out_of_the_folder(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    rest = read_mjcf(written(tmp_path, CHAIN.replace('size="0.04"', 'size="0.04" rgba="nan 0 0 1"'))).left_out.rest
    assert [text for text in rest if re.match(r"MuJoCo's warning: .*NaN", text)]
    assert not Path("MUJOCO_LOG.TXT").exists()
    assert capfd.readouterr().err == ""


def test_actuators_damp_and_weigh_by_the_square_of_their_gear(tmp_path):
    text = CHAIN.replace("<joint ", '<joint damping="2" frictionloss="0.5" armature="0.1" ', 1)
    motors = '<motor joint="q2" gear="3" damping="0.2" armature="0.01"/><motor joint="q2" damping="1" gear="-1"/>'
    path = written(tmp_path, text.replace("</worldbody>", f"</worldbody><actuator>{motors}</actuator>"))
    given = dynamics_of(read_arm(path), "arm.xml", 9.81)
    np.testing.assert_allclose(given.damping, [2.0, 2.0 + 9.0 * 0.2 + 1.0, 2.0], rtol=1e-15)
    np.testing.assert_allclose(given.armature, [0.1, 0.1 + 9.0 * 0.01, 0.1], rtol=1e-15)
    assert given.friction.tolist() == [0.5, 0.5, 0.5]
