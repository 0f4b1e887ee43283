"""Unusual but valid files: their canonical text is that of the usual file, so that every engine reads the same arm."""

import math

import numpy as np
import pytest
from support import unusual_arms as unusual
from support.unusual_arms import LIMIT, ORIGIN, Z, arm, first, fixed, joint, link, second

from runner.base.errors import ConfigError
from runner.robots.description import read_urdf
from runner.robots.joint_dynamics import dynamics_of
from runner.robots.model import RobotModel
from runner.robots.tree import read_tree

HALF = 1.0 / math.hypot(1.0, 1.0)
FRAME = '<link name="tool0"><inertial><origin xyz="0 0 0"/><mass value="0"/><inertia {}/></inertial></link>\n{}'.format(
    " ".join(f'{key}="0"' for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")), fixed("end", "l3", "tool0")
)
SPECK = link("tool0", "1e-15", " ".join(f'{key}="1e-15"' for key in ("ixx", "iyy", "izz")) + ' ixy="0" ixz="0" iyz="0"',
             "0 0 0") + fixed("end", "l3", "tool0")  # fmt: skip
BLANKS = 'ixx=" 0.01" ixy="0" ixz="+0" iyy="1.2E-2 " iyz="0 " izz="0.008\n"'
XACRO = ' xmlns:xacro="http://www.ros.org/wiki/xacro"'

SAME = {
    "axis of length 2": (first(axis='<axis xyz="0 0 2"/>'), arm()),
    "axis of length 0.5": (second(axis='<axis xyz="0 0.5 0"/>'), arm()),
    "axis along a diagonal": (second(axis='<axis xyz="1 1 0"/>'), second(axis=f'<axis xyz="{HALF!r} {HALF!r} 0"/>')),
    "no axis": (second(axis=""), second(axis='<axis xyz="1 0 0"/>')),
    "axis without direction": (second(axis="<axis/>"), second(axis='<axis xyz="1 0 0"/>')),
    "only an upper limit": (first(limit=LIMIT.replace('lower="-2" ', "")), first(limit=LIMIT.replace("-2", "0"))),
    "only a lower limit": (first(limit=LIMIT.replace('upper="2" ', "")), first(limit=LIMIT.replace('"2"', '"0"'))),
    "blanks": (arm(links=link("base") + link("l1", " 1.0 ", BLANKS, "0.01  0.02 0.1 ") + link("l2") + link("l3")),
               arm()),
    "blanks in limits": (first(limit=LIMIT.replace('"-2"', '"-2 "').replace('"50"', '" 50"')), arm()),
    "no limit as inf": (first(limit=LIMIT.replace('"50"', '"inf"')), first(limit=LIMIT.replace('"50"', '"1e6"'))),
    "damping in words": (
        arm(third=joint("j3", "l2", "l3", more='<dynamics damping="high"/>')),
        arm(third=joint("j3", "l2", "l3", more='<dynamics damping="0" friction="0"/>')),
    ),
    "version 1": (arm(head=' version="1"'), arm()),
    "version 1.3": (arm(head=' version="1.3"'), arm()),
    "xacro definition": (arm(head=XACRO, tail='<xacro:property name="w" value=".2"/>'), arm()),
    "xacro without declaration": (arm(tail='<xacro:macro name="m"><a b="${w}"/></xacro:macro>'), arm()),
    "placeholder mass": (arm(tool=SPECK), arm(tool=FRAME)),
    "elements of programs": (arm(tail='<gazebo reference="l1"/><material name="red"/><drake:x/>'), arm()),
    "bullet's own": (arm(links=link("base") + link("l1").replace("</link>", '<contact><inertia_scaling value="9"/>'
                     "</contact></link>") + link("l2") + link("l3")), arm()),
}  # fmt: skip


@pytest.fixture
def file(tmp_path):
    def write(text, name="arm.urdf"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize("case", SAME)
def test_all_engines_get_the_text_of_the_usual_file(file, case):
    text, usual = SAME[case]
    assert text != usual
    canonical = read_urdf(file(text), {})
    assert canonical == read_urdf(file(usual), {})
    assert read_urdf(file(canonical), {}) == canonical
    assert RobotModel(canonical, "tool0").nq == 3


def test_an_orientation_by_quaternion_is_roll_pitch_and_yaw(file):
    half = math.radians(22.5)
    quaternion = f'<origin xyz="0 0 0.3" quat_xyzw="{2 * math.sin(half)!r} 0 0 {2 * math.cos(half)!r}"/>'
    rpy = f'<origin xyz="0 0 0.3" rpy="{math.radians(45)!r} 0 0"/>'
    one, other = (RobotModel(read_urdf(file(second(origin=origin)), {}), "tool0") for origin in (quaternion, rpy))
    for q in np.random.default_rng(0).uniform(-2.0, 2.0, (5, 3)):
        np.testing.assert_allclose(one.tip_pose(q), other.tip_pose(q), atol=1e-15)
        np.testing.assert_allclose(one.mass_matrix(q), other.mass_matrix(q), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (second(origin='<origin rpy="0 0 1" quat_xyzw="0 0 0 1"/>'), "joint 'j2' in .* has <origin quat_xyzw="
         "'0 0 0 1'>; allowed: four numbers, not all zero, and no rpy with them"),
        (second(origin='<origin quat_xyzw="0 0 0 0"/>'), "joint 'j2' in .* <origin quat_xyzw='0 0 0 0'>; all"),
        (second(axis='<axis xyz="1_0 0 0"/>'), "joint 'j2' in .* has <axis xyz='1_0 0 0'>; allowed: three numbers"),
        (first(limit=""), "no <limit>; give it lower, upper, effort and velocity, 1000000 for none"),
        (first(limit='<limit effort="1" velocity="1"/>'), "no position limits; give lower and upper, -1000000 and"),
        (first(limit='<limit lower="-1" upper="1" velocity="1"/>'), "no effort limit; give it, 1000000 for none"),
        (first(limit='<limit lower="-1" upper="1" effort="1"/>'), "joint 'j1' in .* has no velocity limit"),
        (arm(head=XACRO, tail='<xacro:call/>'), r"uses xacro; make a URDF of it first: xacro arm.urdf > arm_made.urdf"),
        (arm(head=XACRO, tail='<mesh filename="$(find pkg)/a.stl"/>'), "uses xacro"),
        (arm(tool=SPECK.replace('"1e-15"', '"1e-3"', 4).replace('mass value="1e-3"', 'mass value="1e-15"')),
         "link 'tool0' in .* has mass 1e-15 kg; allowed: 0, or 1e-12"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_told_in_one_sentence(file, text, said):
    with pytest.raises(ConfigError, match=said) as raised:
        read_urdf(file(text), {})
    assert len(raised.value.problems) == 1


TRANSMISSION = (
    '<transmission><joint name="j3"/><actuator name="m"><drake:rotor_inertia value="2e-5"/>'
    '<drake:gear_ratio value="100"/></actuator></transmission>'
)
REDUCTION = (
    '<transmission name="t"><joint name="{0}"/><actuator name="m"><mechanicalReduction>{1}</mechanicalReduction>'
    "</actuator></transmission>"
)


@pytest.mark.parametrize("head", ["", ' xmlns:drake="http://drake.mit.edu"'])
def test_the_inertia_of_a_rotor_is_reflected_to_its_joint(file, head):
    path = file(arm(head=head, tail=TRANSMISSION))
    given = dynamics_of(read_tree(path), "arm.urdf", 9.81)
    assert given.armature.tolist() == pytest.approx([0.0, 0.0, 0.2])
    assert given.left_out == ()
    assert RobotModel(read_urdf(path, {}), "tool0").armature.tolist() == [0.0, 0.0, 0.0]  # robot.armature sets it


def test_reductions_and_springs_are_named(file):
    tail = REDUCTION.format("j1", 100) + REDUCTION.format("j2", 100) + REDUCTION.format("j3", "1")
    spring = '<gazebo reference="j3"><springStiffness>5</springStiffness></gazebo>'
    given = dynamics_of(read_tree(file(arm(tail=tail + spring))), "arm.urdf", 9.81)
    assert given.left_out == (
        "reduction 100 of j1, j2, without the inertia of a rotor (robot.armature)",
        "springs of the joints j3 (springStiffness); no key",
    )


def test_the_changes_of_meaning_are_told(file):
    text = arm(
        joint("j1", "base", "l1", '<axis xyz="0 0 2"/>', limit=LIMIT.replace('lower="-2" ', "")),
        joint("j2", "l1", "l2", ""),
        joint("j3", "l2", "l3", origin='<origin quat_xyzw="0 0 0 2"/>', limit=LIMIT.replace('"50"', '"inf"')),
        XACRO, '<xacro:property name="w"/>', tool=SPECK,
    )  # fmt: skip
    assert [" | ".join(change) for change in read_tree(file(text)).changes] == [
        "xacro | definitions that nothing uses: 'w' | now left out",
        "link 'tool0' | a mass of 1e-15 kg, which is a placeholder | now a frame without mass",
        "joint 'j1' | axis 0 0 2 of length 2 | now of length 1",
        "joint 'j1' | no lower position limit | now 0, the default of the format",
        "joint 'j2' | no axis | now 1 0 0, the default of the format",
        "joint 'j3' | origin by quaternion 0 0 0 2 | now rpy 0 0 0",
        "joint 'j3' | effort limit of inf | now 1e6 in size: without limit",
    ]
    assert read_tree(file(arm(second=joint("j2", "l1", "l2", origin=ORIGIN, axis=Z)))).changes == ()
    assert unusual.INERTIA in arm()
