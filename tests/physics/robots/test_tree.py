"""URDF tree: root, ends and ways between links; files that are none are refused."""

import numpy as np
import pytest
from support import strangers

from runner.base.errors import ConfigError
from runner.robots.description import read_urdf
from runner.robots.model import RobotModel
from runner.robots.tree import read_tree

LINKS = '<link name="a"/><link name="b"/><link name="c"/>'


def joint(name, parent, child, kind="revolute"):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/></joint>'


@pytest.fixture
def read(tmp_path):
    def make(text, name="arm.urdf"):
        path = tmp_path / name
        path.write_text(text)
        return read_tree(path)

    return make


def test_a_tree_knows_its_root_its_ends_and_the_ways_to_links(read):
    joints = joint("q", "a", "b") + joint("r", "a", "c", "fixed")
    tree = read(f'<robot name="x">{LINKS}{joints}<transmission><joint name="q"/></transmission></robot>')
    assert (tree.root, tree.ends, tree.way("b"), tree.way("a")) == ("a", ["b", "c"], ["q"], [])


@pytest.mark.parametrize(
    ("joints", "problem"),
    [
        (joint("q", "a", "b") + joint("r", "b", "c") + joint("s", "c", "a"), "joints run in a circle, and no link is"),
        (joint("q", "b", "c") + joint("r", "c", "b"), "the links b, c run in a circle, apart from the base 'a'"),
        (joint("q", "a", "b"), "it holds several trees, with the bases a, c; join them by a fixed joint"),
        (joint("q", "a", "b") + joint("r", "c", "b"), "link 'b' is borne by 2 joints"),
        (joint("q", "a", "b") + joint("q", "b", "c"), "2 joints have the name 'q'"),
        (
            joint("q", "a", "bb") + joint("r", "a", "c"),
            r"joint 'q' has a child 'bb', which is not a link \(did you mean b",
        ),
    ],
    ids=["circle", "circle apart", "two trees", "two parents", "same name", "no link"],
)
def test_what_is_no_tree(read, joints, problem):
    with pytest.raises(ConfigError, match=problem):
        read(f'<robot name="x">{LINKS}{joints}</robot>')


def test_entities_that_grow_are_refused_before_they_do(read):
    doctype = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
    with pytest.raises(ConfigError, match=r"document type \(<!DOCTYPE>\), which no arm needs; remove it"):
        read(f'{doctype}<robot name="&b;">{LINKS}</robot>')


@pytest.mark.parametrize("head", ['<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="x">', '<robot name="x">'])
def test_xacro_is_no_urdf(read, head):
    with pytest.raises(ConfigError, match=r"make a URDF of it first: xacro arm.urdf > arm_made.urdf \(pip has xacro\)"):
        read(f'{head}<xacro:property name="r" value="1"/><xacro:arm/>{LINKS}</robot>')


def test_a_folder_cannot_be_read(tmp_path):
    with pytest.raises(ConfigError, match="cannot be read: Is a directory"):
        read_tree(tmp_path)


def test_a_branched_arm_is_no_robot_of_a_config(tmp_path):
    text = strangers.chain("arm", [("revolute", strangers.X), ("revolute", strangers.Y)])
    branch = strangers.link("side", 1.0, 0.1) + joint("q9", "l0", "side").replace(
        "</joint>", '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    )
    (tmp_path / "arm.urdf").write_text(text.replace("</robot>", branch + "</robot>"))
    with pytest.raises(ConfigError, match=r"branches: q9 move in addition to q1, q2; allowed: a serial arm"):
        read_urdf(tmp_path / "arm.urdf", {})


def test_a_single_joint_behind_the_tip_counts_as_one_of_the_arm(tmp_path):
    text = strangers.chain("arm", [("revolute", strangers.X), ("revolute", strangers.Y)])
    jaw = joint("jaw", "tip", "finger", "prismatic").replace(
        "</joint>", '<limit lower="0" upper="0.04" effort="1" velocity="1"/></joint>'
    )
    (tmp_path / "arm.urdf").write_text(text.replace("</robot>", f'<link name="finger"/>{jaw}</robot>'))
    model = RobotModel(read_urdf(tmp_path / "arm.urdf", {}), "tip")
    assert model.joint_names == ("q1", "q2", "jaw")
    assert not model.tip_jacobian(np.zeros(3))[:, 2].any()


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        (
            "</joint>",
            '<dynamics friction="-1.5"/></joint>',
            r"joint 'q1' in .* has <dynamics friction='-1.5'>; allowed",
        ),
        ('mass value="2.0"', 'mass value="4,0"', r"link 'l1' in .* has <mass value='4,0'>; allowed: a number of 0 or"),
        ('mass value="2.0"', 'mass value="-4"', r"link 'l1' in .* has mass -4 kg; allowed: 0 or more"),
    ],
)
def test_values_of_a_file_that_are_wrong_are_quoted(tmp_path, old, new, problem):
    text = strangers.chain("arm", [("revolute", strangers.X), ("revolute", strangers.Y)])
    (tmp_path / "arm.urdf").write_text(text.replace(old, new, 1))
    with pytest.raises(ConfigError, match=problem):
        read_urdf(tmp_path / "arm.urdf", {})


def test_a_mimicking_joint_is_refused(tmp_path):
    text = strangers.chain("arm", [("revolute", strangers.X), ("revolute", strangers.Y)])
    text = text.replace('<child link="l2"/>', '<child link="l2"/><mimic joint="q1"/>')
    (tmp_path / "arm.urdf").write_text(text)
    with pytest.raises(ConfigError, match=r"joint 'q2' in .* mimics 'q1', and its motion would be free; take"):
        read_urdf(tmp_path / "arm.urdf", {})


def test_meshes_are_left_out_and_other_shapes_kept(tmp_path):
    text = strangers.chain("arm", [("revolute", strangers.X)])
    shapes = "".join(
        f"<{role}><geometry>{shape}</geometry></{role}>"
        for role in ("visual", "collision")
        for shape in ('<mesh filename="package://nowhere/a.stl"/>', '<sphere radius="0.1"/>')
    )
    (tmp_path / "arm.urdf").write_text(text.replace('<link name="l1">', f'<link name="l1">{shapes}'))
    kept = read_urdf(tmp_path / "arm.urdf", {})
    assert "mesh" not in kept
    assert kept.count("<sphere") == 2


def attributes(count):
    return " ".join(f"a{number}='0'" for number in range(count))


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("<a/>" * 19_990, "has 20,001 elements; allowed: up to 20,000"),
        (f"<a {attributes(201)}/>", "has 201 attributes in an element; allowed: up to 200"),
        ("<!--" + "x" * 5_000_000 + "-->", "bytes; allowed: up to 5,000,000"),
    ],
    ids=["elements", "attributes", "bytes"],
)
def test_what_is_too_much_is_refused_before_it_is_kept(read, more, told):
    arm = f'<robot name="x">{LINKS}{joint("q", "a", "b")}{joint("r", "b", "c")}MORE</robot>'  # 10 elements
    assert read(arm.replace("MORE", f"<a {attributes(200)}/>" + "<a/>" * 19_989)).root == "a"
    with pytest.raises(ConfigError, match=told):
        read(arm.replace("MORE", more + "<a/>"))
