"""Inverse kinematics against forward kinematics, within joint limits and on the branch of home."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.arms import model_of, urdf_of

from runner.base.errors import ConfigError
from runner.robots import inverse_kinematics
from runner.robots.inverse_kinematics import solve_tip_pose, solve_tip_position
from runner.robots.mismatch import MismatchConfig, build
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, Stage

MODELS = {name: model_of(name) for name in ("macro", "mini")}
LENGTH = {"macro": 1.0, "mini": 0.1}
HOME = np.zeros(3)
XARM7_URDF = urdf_of("xarm7")
XARM7, XARM7_HOME = RobotModel(XARM7_URDF, "flange"), np.array([0.0, 0.75, 0.0, 1.5, 0.0, 0.75, 0.0])
MECA500 = model_of("meca500", "flange")
MECA500_HOME = np.array([0.0, 0.5, 0.0, 0.0, 1.0707963267948966, 0.0])

names = st.sampled_from(sorted(MODELS))


@st.composite
def targets(draw):
    """Arm and a target inside its workspace, off the surfaces where its Jacobian is singular."""
    name = draw(names)
    radius, azimuth = draw(st.floats(0.2, 1.9)), draw(st.floats(-3.0, 3.0))
    height = draw(st.floats(-0.9, 0.9))  # sine of the elevation
    across = np.sqrt(1.0 - height**2)
    direction = np.array([-across * np.sin(azimuth), across * np.cos(azimuth), height])
    return name, LENGTH[name] * radius * direction


def postures(model, count):
    lower, upper = np.clip(model.position_limits, -3.0, 3.0)
    return np.random.default_rng(2).uniform(lower, upper, (count, model.nq))


@pytest.mark.parametrize("name", ["macro", "mini"])
def test_the_home_tip_gives_home_exactly(name):
    home = np.array([0.2, -0.3, 0.1])
    for posture in (HOME, home):
        found = solve_tip_position(MODELS[name], MODELS[name].tip_position(posture), posture)
        np.testing.assert_array_equal(found, posture)
        assert found is not posture


@given(targets())
def test_a_target_in_the_workspace_is_reached_on_the_home_branch(target):
    name, position = target
    q = solve_tip_position(MODELS[name], position, HOME)
    assert np.linalg.norm(MODELS[name].tip_position(q) - position) < 1e-9
    assert np.cos(q[2]) > 0.0  # the elbow's side: cos q3 changes its sign where the arm is stretched or folded


@given(targets())
def test_the_way_back_leads_home(target):
    name, position = target
    model = MODELS[name]
    there = solve_tip_position(model, position, HOME)
    back = solve_tip_position(model, model.tip_position(HOME), there)
    np.testing.assert_allclose(back, HOME, atol=1e-9)


@given(names, st.lists(st.floats(-0.5, 0.5), min_size=3, max_size=3))
def test_near_home_the_posture_is_the_one_that_gave_the_tip(name, posture):
    model = MODELS[name]
    np.testing.assert_allclose(
        solve_tip_position(model, model.tip_position(np.array(posture)), HOME), posture, atol=1e-9
    )


@pytest.mark.parametrize("name", ["macro", "mini"])
def test_the_thesis_goal_is_reached(name):
    goal = LENGTH[name] * np.array([0.1679, -0.7571, 0.4255])
    q = solve_tip_position(MODELS[name], goal, HOME)
    assert np.linalg.norm(MODELS[name].tip_position(q) - goal) < 1e-9


def test_home_is_only_read():
    home = np.zeros(3)
    home.setflags(write=False)
    solve_tip_position(MODELS["macro"], np.array([0.3, 0.9, 1.0]), home)


AWAY = [
    pytest.param(
        name, direction, excess, marks=[pytest.mark.slow] if name == "mini" or (number and excess > 1e-6) else []
    )
    for name in ("macro", "mini")
    for number, direction in enumerate([[0.0, 1.0, 1.0], [1.0, 0.2, 0.3], [-1.0, -1.0, 0.5]])
    for excess in (1e-6, 0.1, 10.0)
]  # the Mini is the Macro, a tenth as large; one direction has each excess


@pytest.mark.parametrize(("name", "direction", "excess"), AWAY)
def test_beyond_the_reach_is_refused_with_what_is_left(name, direction, excess):
    model = MODELS[name]
    unit = np.array(direction) / np.linalg.norm(direction)
    with pytest.raises(ConfigError) as caught:
        solve_tip_position(model, unit * model.reach * (1.0 + excess), HOME)
    left, there, here = told(caught.value)
    assert left == pytest.approx(excess * model.reach, rel=0.01)  # straight on, as the nearest point of a ball
    assert there == pytest.approx(model.reach * (1.0 + excess), rel=1e-3)
    assert here == pytest.approx(model.reach, rel=1e-3)


def told(error):
    """Return the remaining distance, and the target's and the nearest tip's distance from the shoulder, in m."""
    number = r"([\d.e+-]+)"
    pattern = rf"{number} m are left; it lies {number} m from the shoulder, the nearest found {number} m"
    return tuple(float(value) for value in re.search(pattern, str(error)).groups())


# Joint limits, and arms with more joints than a tip position needs.


@pytest.mark.parametrize("y", [-0.2, 0.0, 0.2])
@pytest.mark.parametrize("x", [0.643, 0.6043])
def test_the_xarm7_reaches_its_line_near_home(x, y):
    q = solve_tip_position(XARM7, np.array([x, y, 0.1508]), XARM7_HOME)
    assert np.linalg.norm(XARM7.tip_position(q) - [x, y, 0.1508]) < 1e-12
    assert XARM7.limit_margins(q).min() > 1.1
    assert np.abs(q - XARM7_HOME).max() < 0.35


@pytest.mark.parametrize(("model", "home"), [(XARM7, XARM7_HOME), (MECA500, MECA500_HOME)], ids=["xarm7", "meca500"])
def test_what_some_posture_reaches_is_reached_within_the_limits(model, home):
    for posture in postures(model, 4):
        position = solve_tip_position(model, model.tip_position(posture), home)
        assert np.linalg.norm(model.tip_position(position) - model.tip_position(posture)) < 1e-9
        pose = solve_tip_pose(model, model.tip_pose(posture), home)
        np.testing.assert_allclose(model.tip_pose(pose), model.tip_pose(posture), rtol=0, atol=2e-9)
        assert min(model.limit_margins(position).min(), model.limit_margins(pose).min()) >= 0.0


def test_a_joint_stops_at_its_limit_and_the_others_go_on():
    # Straight above the shoulder and bent backwards, joint 4 would have to turn past -11 deg without limits.
    free = RobotModel(re.sub('lower="[^"]*" upper="[^"]*"', 'lower="-99" upper="99"', XARM7_URDF), "flange")
    home = np.array([0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0])
    target = free.tip_position(np.array([0.0, 0.3, 0.0, -0.5, 0.0, 0.3, 0.0]))
    q = solve_tip_position(free, target, home)
    assert XARM7.limit_margins(q).min() < -0.05
    inside = solve_tip_position(XARM7, target, home)
    assert np.linalg.norm(XARM7.tip_position(inside) - target) < 1e-9
    assert XARM7.limit_margins(inside).min() >= 0.0


@pytest.mark.parametrize("angle", [0.3, 2.0, 3.1])
def test_a_pose_turned_about_the_tip_s_own_axis_turns_the_last_joint(angle):
    pose = MECA500.tip_pose(MECA500_HOME)
    c, s = np.cos(angle), np.sin(angle)
    pose[:3, :3] = pose[:3, :3] @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(
        solve_tip_pose(MECA500, pose, MECA500_HOME), MECA500_HOME + angle * np.eye(6)[5], atol=1e-9
    )


def test_the_home_pose_gives_home_exactly():
    np.testing.assert_array_equal(solve_tip_pose(XARM7, XARM7.tip_pose(XARM7_HOME), XARM7_HOME), XARM7_HOME)


def test_a_pose_near_home_stays_on_its_branch():
    posture = MECA500_HOME + np.array([0.3, -0.2, 0.25, 0.2, -0.3, 0.4])
    found = solve_tip_pose(MECA500, MECA500.tip_pose(posture), MECA500_HOME)
    np.testing.assert_allclose(found, posture, atol=1e-9)


def test_a_pose_out_of_reach_says_how_far():
    pose = MECA500.tip_pose(MECA500_HOME)
    pose[0, 3] = 0.4
    with pytest.raises(ConfigError, match=r"no posture found .* with the rotation vector .* m and .* rad are left"):
        solve_tip_pose(MECA500, pose, MECA500_HOME)


def test_a_wrist_out_of_reach_says_how_far_though_the_tip_is_not():
    pose = np.eye(4)
    pose[:3, :3] = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]  # pointing back at the arm
    pose[:3, 3] = 0.25, 0.0, 0.25  # the wrist would lie 0.07 m further out, 0.34 m from the shoulder
    solve_tip_position(MECA500, pose[:3, 3], MECA500_HOME)
    with pytest.raises(ConfigError, match=r"m and 0\.\d+ rad are left; it lies 0\.2752 m from the shoulder"):
        solve_tip_pose(MECA500, pose, MECA500_HOME)


# Asked again.


def test_a_posture_is_found_once_for_all_arms_of_the_same_kinematics(monkeypatch):
    target = XARM7.tip_position(XARM7_HOME) + np.array([0.0123, 0.0456, -0.0789])
    first = solve_tip_position(XARM7, target, XARM7_HOME)
    expected = first.copy()
    first += 1.0  # whoever asked may change it
    monkeypatch.setattr(inverse_kinematics, "_follow", None)  # nothing is led anywhere any more
    again, loaded = RobotModel(XARM7_URDF, "flange"), XARM7.with_payload(2.0)
    for model in (XARM7, again, loaded):
        np.testing.assert_array_equal(solve_tip_position(model, target, XARM7_HOME), expected)
    longer = believed_longer(XARM7)
    for model, wanted, home in (
        (longer, target, XARM7_HOME),
        (XARM7.with_tip("link5"), target, XARM7_HOME),
        (XARM7, target + 1e-9, XARM7_HOME),
        (XARM7, target, XARM7_HOME + 1e-9),
    ):
        with pytest.raises(TypeError):
            solve_tip_position(model, wanted, home)


def believed_longer(model):
    stage = Stage("arm", model, XARM7_URDF, slice(0, model.nq), XARM7_HOME, None)
    longer = MismatchConfig(mass=1.0, centre_of_mass=1.0, length=1.001, gravity=1.0, payload=0.0, spread=0.0, link={})
    robot = Robot(XARM7_URDF, model, (stage,), "flange")
    return build(longer, robot, np.random.default_rng(0)).model
