"""Links as bodies of a playback, against the forward kinematics."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from runner.reporting.playback import playback_bodies
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
BOX_ARM = f"""
<robot name="box_arm">
  <link name="base">{INERTIAL}</link>
  <joint name="q1" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <link name="arm">{INERTIAL}
    <visual><origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/><geometry><box size="0.3 2 0.4"/></geometry></visual>
  </link>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="2 0 0"/></joint>
  <link name="tip">{INERTIAL}</link>
</robot>"""


def macro() -> tuple[str, RobotModel]:
    text = read_urdf(find_urdf("macro.urdf"), {})
    return text, RobotModel(text, "tip")


def world(body, instant, point):
    return body.positions[instant] + Rotation.from_quat(body.rotations[instant], scalar_first=True).apply(point)


def test_every_visible_link_has_a_pose_at_each_instant():
    text, model = macro()
    q = np.random.default_rng(0).normal(size=(7, 3))
    bodies = playback_bodies(text, model, q)
    assert [body.name for body in bodies] == ["base", "link1", "link2", "link3", "tip"]
    assert [body.color for body in bodies] == [0, 1, 2, 3, 3]
    for body in bodies:
        assert body.positions.shape == (7, 3)
        assert body.rotations.shape == (7, 4)
        np.testing.assert_allclose(np.linalg.norm(body.rotations, axis=1), 1.0, rtol=1e-12)
        assert len(body.segments) + len(body.balls) > 0


def test_the_last_link_ends_at_the_tip_and_the_base_stays():
    text, model = macro()
    q = np.random.default_rng(1).normal(size=(20, 3))
    bodies = {body.name: body for body in playback_bodies(text, model, q)}
    (_, end, radius) = bodies["link3"].segments[0]
    assert radius == 0.04
    for instant, tip in enumerate(model.tip_positions(q)):
        np.testing.assert_allclose(world(bodies["link3"], instant, end), tip, atol=1e-12)
        np.testing.assert_allclose(world(bodies["tip"], instant, bodies["tip"].balls[0][0]), tip, atol=1e-12)
        np.testing.assert_allclose(bodies["base"].positions[instant], 0.0, atol=1e-15)


def test_links_hang_together():
    text, model = macro()
    q = np.random.default_rng(2).normal(size=(5, 3))
    bodies = {body.name: body for body in playback_bodies(text, model, q)}
    for instant in range(5):
        end = world(bodies["link2"], instant, bodies["link2"].segments[0][1])
        np.testing.assert_allclose(end, bodies["link3"].positions[instant], atol=1e-12)


def test_quaternions_never_jump_in_sign():
    text, model = macro()
    q = np.linspace(0.0, 4 * np.pi, 200)[:, None] * np.array([1.0, 0.0, 0.0])
    for body in playback_bodies(text, model, q):
        assert np.einsum("ij,ij->i", body.rotations[1:], body.rotations[:-1]).min() > 0.9


def test_a_box_becomes_the_cylinder_around_its_longest_side_and_a_bare_link_a_bone():
    bodies = {body.name: body for body in playback_bodies(BOX_ARM, RobotModel(BOX_ARM, "tip"), np.zeros((1, 1)))}
    start, end, radius = bodies["arm"].segments[0]
    np.testing.assert_allclose(sorted([start, end]), [[0, 0, 0], [2, 0, 0]], atol=1e-12)
    assert radius == pytest.approx(0.25)
    assert bodies["base"].segments[0][:2] == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.5))
    assert "tip" not in bodies
