"""Fixed joints, compared with Pinocchio's model with these joints fixed; damping and friction of a file."""

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from support import strangers
from support.strangers import X, Y, Z

from runner.robots.joint_dynamics import dynamics_of, hold, rest_position
from runner.robots.tree import make_tree

ARM = strangers.chain("arm", [("revolute", Z), ("prismatic", "0 1 2"), ("revolute", "1 -1 3"), ("revolute", X)])
ARM = ARM.replace('name="q4" type="revolute"', 'name="q4" type="continuous"')
HELD = {"q2": 0.3, "q3": -0.7, "q4": 2.0}


def tree_of(text):
    return make_tree(ET.fromstring(text), Path("arm.urdf"))


def test_an_arm_with_joints_held_is_the_arm_with_them_there():
    tree = replace(tree_of(ARM), home=HELD)
    for name in HELD:
        assert rest_position(tree, name) == HELD[name]
        hold(tree, name, HELD[name])
    ours, theirs = (pin.buildModelFromXML(text) for text in (ET.tostring(tree.robot, encoding="unicode"), ARM))
    data, others = ours.createData(), theirs.createData()
    assert list(ours.names)[1:] == ["q1"]
    for angle in np.linspace(-2.5, 2.5, 7):
        q = np.array([angle, HELD["q2"], HELD["q3"], np.cos(HELD["q4"]), np.sin(HELD["q4"])])
        M = pin.crba(theirs, others, q)
        np.testing.assert_allclose(pin.crba(ours, data, q[:1])[0, 0], M[0, 0], rtol=1e-12)
        pin.framesForwardKinematics(ours, data, q[:1])
        pin.framesForwardKinematics(theirs, others, q)
        poses = [d.oMf[m.getFrameId("tip")].homogeneous for m, d in ((ours, data), (theirs, others))]
        np.testing.assert_allclose(*poses, atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "limit", "home", "held"),
    [
        ("revolute", 'lower="-1" upper="1"', None, 0.0),
        ("revolute", 'lower="0.2" upper="1"', None, 0.2),
        ("prismatic", 'lower="-2" upper="-0.5"', None, -0.5),
        ("revolute", 'lower="-1" upper="1"', 0.4, 0.4),
        ("revolute", 'lower="-1" upper="1"', 3.0, 1.0),
        ("continuous", 'lower="0" upper="0"', 3.0, 3.0),
        ("revolute", 'lower="1" upper="-1"', None, 0.0),
        ("floating", "", None, 0.0),
    ],
)
def test_a_joint_is_held_at_home_or_as_near_to_zero_as_it_comes(kind, limit, home, held):
    text = strangers.chain("arm", [("revolute", Z), ("revolute", Y)])
    text = text.replace('lower="-2.8" upper="2.8"', limit).replace('type="revolute"', f'type="{kind}"')
    tree = replace(tree_of(text), home={} if home is None else {"q1": home})
    assert rest_position(tree, "q1") == held
    hold(tree, "q1", held)
    joint = tree.joints["q1"]
    assert joint.get("type") == "fixed"
    assert {element.tag for element in joint} == {"origin", "parent", "child"}


def test_damping_and_friction_are_as_the_file_gives_them():
    text = strangers.chain("arm", [("revolute", Z), ("revolute", Y), ("revolute", Y)])
    text = text.replace('<child link="l1"/>', '<child link="l1"/><dynamics damping="2" friction="0.5" armature="0.1"/>')
    text = text.replace('<child link="l2"/>', '<child link="l2"/><dynamics damping="-1" friction="much"/>')
    given = dynamics_of(tree_of(text), "arm.urdf", 9.81)
    assert given.damping.tolist() == [2.0, 0.0, 0.0]
    assert given.friction.tolist() == [0.5, 0.0, 0.0]
    assert given.armature.tolist() == [0.1, 0.0, 0.0]
