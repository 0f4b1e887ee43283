"""One arm mounted on another: names, places, and the combined arm's numbers."""

import xml.etree.ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest
from support.arms import checked

from runner.base.errors import ConfigError
from runner.papers.studies.thesis.denavit_hartenberg import DenavitHartenbergRow, denavit_hartenberg, frames
from runner.robots.model import RobotModel
from runner.robots.mounting import mount
from runner.schema.values import MountConfig

AT_TIP = MountConfig(frame="tip", translation=[0.0, 0.0, 0.0], rotation=[np.pi / 2, 0.0, np.pi / 2])
# Recovered Table 5.1, and torques and tip positions of the printed equations at one state.
TABLE_5_1 = tuple(
    DenavitHartenbergRow(np.deg2rad(theta), d, a, np.deg2rad(alpha))
    for theta, d, a, alpha in zip(
        (90, 0, 180, 180, 0, 90), (0, 0, 0, 1, 0, 0), (0, 1, 0, 0, 0.1, 0.1), (90, 0, 90, 90, 0, 90), strict=True
    )
)
Q, DQ = np.array([0.3, -0.5, 0.7, 0.2, -0.4, 0.9]), np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
DDQ = DQ[::-1].copy()
TAU = [0.756871, 17.639557, -1.458317, 0.001641, 0.132384, -0.057832]
TIP = [-0.218685, 0.677258, 0.557083]
MACRO_TAU, MACRO_TIP = [0.701956, 16.105894, -1.333807], [-0.200633, 0.648591, 0.500641]
LAST_DIGIT = 5.000001e-7


@pytest.fixture(scope="module")
def mounted(macro_urdf, mini_urdf):
    return mount(macro_urdf, mini_urdf, "mini_", AT_TIP)


def names(urdf, kind):
    return [element.get("name") for element in ET.fromstring(urdf).findall(kind)]


def inverse_dynamics(model, q, dq, ddq):
    return model.mass_matrix(q) @ ddq + model.coriolis_torque(q, dq) + model.gravity_torque(q)


def test_the_rider_takes_the_prefix_and_the_carrier_keeps_its_names(mounted, macro_urdf, mini_urdf):
    urdf, root = mounted
    assert root == "mini_base"
    for kind in ("link", "joint"):
        macro_names, mini_names = names(macro_urdf, kind), [f"mini_{name}" for name in names(mini_urdf, kind)]
        found = names(urdf, kind)
        assert found[: len(macro_names)] == macro_names
        assert sorted(found) == sorted([*macro_names, *mini_names, *(["mini_mount"] if kind == "joint" else [])])


def test_every_link_keeps_its_inertia(mounted, macro_urdf, mini_urdf):
    links = {link.get("name"): ET.tostring(link.find("inertial")) for link in ET.fromstring(mounted[0]).iter("link")}
    for prefix, urdf in (("", macro_urdf), ("mini_", mini_urdf)):
        for link in ET.fromstring(urdf).iter("link"):
            assert links[prefix + link.get("name")].strip() == ET.tostring(link.find("inertial")).strip()


def test_mounting_changes_neither_text(macro_urdf, mini_urdf):
    before = macro_urdf, mini_urdf
    mount(macro_urdf, mini_urdf, "mini_", AT_TIP)
    assert (macro_urdf, mini_urdf) == before


@pytest.mark.parametrize(
    ("frame", "translation", "rotation"),
    [
        ("tip", [0.0, 0.0, 0.0], [np.pi / 2, 0.0, np.pi / 2]),
        ("link2", [0.1, -0.2, 0.3], [0.4, -0.5, 0.6]),
        ("base", [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]),
    ],
)
def test_the_rider_stands_where_the_mount_says(macro_urdf, mini_urdf, mini, frame, translation, rotation):
    urdf, root = mount(
        macro_urdf, mini_urdf, "mini_", MountConfig(frame=frame, translation=translation, rotation=rotation)
    )
    model = RobotModel(urdf, "mini_tip")
    step = np.eye(4)
    step[:3, :3], step[:3, 3] = pin.rpy.rpyToMatrix(*rotation), translation
    for q in np.random.default_rng(0).uniform(-3.0, 3.0, (5, 6)):
        placed, base = model.frame_poses(q, (frame, root))
        np.testing.assert_allclose(base, placed @ step, atol=1e-12)
        # Pinocchio orders the joints of a link by name, so the angles of the mounted stage are read by name.
        own = [q[model.joint_names.index(f"mini_{name}")] for name in mini.joint_names]
        np.testing.assert_allclose(model.tip_pose(q), base @ mini.tip_pose(np.array(own)), atol=1e-12)


def test_a_missing_frame_names_the_nearest(macro_urdf, mini_urdf):
    with pytest.raises(ConfigError) as raised:
        mount(macro_urdf, mini_urdf, "mini_", MountConfig(frame="tpi", translation=[0.0] * 3, rotation=[0.0] * 3))
    assert raised.value.problems == (
        "robot.stages.mini.mount.frame: no link 'tpi' (did you mean tip?); links: base, link1, link2, link3, tip",
    )


def test_names_that_would_stand_twice_are_refused(mounted, mini_urdf):
    with pytest.raises(ConfigError, match=r"robot\.stages\.mini: the link name mini_base stands in the carrying arm"):
        mount(mounted[0], mini_urdf, "mini_", MountConfig(frame="mini_tip", translation=[0.0] * 3, rotation=[0.0] * 3))


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        (
            "robot.stages.macro.mount={frame: tip, translation: [0,0,0], rotation: [0,0,0]}",
            "robot.stages.macro.mount: the first stage is fixed to the ground; allowed: null",
        ),
        (
            "robot.stages.mini.mount=null",
            "robot.stages.mini.mount: missing; a stage above the first needs frame, translation and rotation",
        ),
        ("~robot.stages.mini.mount", "robot.stages.mini.mount: missing"),
    ],
)
def test_the_first_stage_has_no_mount_and_all_others_have_one(override, problem):
    with pytest.raises(ConfigError) as raised:
        checked("robot=combined", override)
    assert raised.value.problems == (problem,)


# The combined arm.


def test_the_combined_arm_has_the_torques_and_tip_of_the_printed_equations(combined):
    np.testing.assert_allclose(inverse_dynamics(combined.model, Q, DQ, DDQ), TAU, rtol=0, atol=LAST_DIGIT)
    np.testing.assert_allclose(combined.model.tip_position(Q), TIP, rtol=0, atol=LAST_DIGIT)


def test_the_macro_alone_has_those_of_the_first_three_joints(combined, macro):
    for model in (macro, combined.stages[0].model):
        torque = inverse_dynamics(model, Q[:3], DQ[:3], DDQ[:3])
        np.testing.assert_allclose(torque, MACRO_TAU, rtol=0, atol=LAST_DIGIT)
        np.testing.assert_allclose(model.tip_position(Q[:3]), MACRO_TIP, rtol=0, atol=LAST_DIGIT)


def test_the_combined_arm_is_the_chain_of_the_recovered_table(combined):
    for q in np.random.default_rng(1).uniform(-np.pi, np.pi, (20, 6)):
        np.testing.assert_allclose(frames(TABLE_5_1, q)[-1], combined.model.tip_pose(q), atol=1e-12)


def test_its_own_table_is_found_from_its_axes(combined):
    found = denavit_hartenberg(combined.model)
    for row, expected in zip(found, TABLE_5_1, strict=True):
        np.testing.assert_allclose(
            [row.theta, row.d, row.a, row.alpha], [expected.theta, expected.d, expected.a, expected.alpha], atol=1e-12
        )


def test_the_home_tip_is_the_thesis_one(combined):
    np.testing.assert_allclose(combined.model.tip_position(np.zeros(6)), [0.0, 1.1, 1.1], atol=1e-15)
    assert combined.model.reach == pytest.approx(2.2)
    assert combined.model.mass == pytest.approx(2.2)


def test_joint_4_lies_along_link_3(combined):
    for q in np.random.default_rng(2).uniform(-np.pi, np.pi, (5, 6)):
        elbow, wrist = combined.model.frame_poses(q, ("link3", "mini_base"))[:, :3, 3]
        axis = combined.model.tip_jacobian(q)[3:, 3]
        np.testing.assert_allclose(axis, wrist - elbow, atol=1e-12)
