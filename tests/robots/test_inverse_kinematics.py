import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.errors import ConfigError
from runner.robots import RobotModel, find_urdf, read_urdf, solve_tip_position

MODELS = {name: RobotModel(read_urdf(find_urdf(f"{name}.urdf"), {}), "tip") for name in ("macro", "mini")}
LENGTH = {"macro": 1.0, "mini": 0.1}
HOME = np.zeros(3)

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


@pytest.mark.parametrize("name", ["macro", "mini"])
@pytest.mark.parametrize("direction", [[0.0, 1.0, 1.0], [1.0, 0.2, 0.3], [-1.0, -1.0, 0.5]])
@pytest.mark.parametrize("excess", [1e-6, 0.1, 10.0])
def test_beyond_the_reach_is_refused_with_what_is_left(name, direction, excess):
    model = MODELS[name]
    unit = np.array(direction) / np.linalg.norm(direction)
    with pytest.raises(ConfigError, match=r"trajectory\.start: no posture .* m are left \(reach [\d.]+ m\)") as caught:
        solve_tip_position(model, unit * model.reach * (1.0 + excess), HOME)
    left = float(str(caught.value).split(" m are left")[0].split("; ")[-1])
    assert left >= 0.99 * excess * model.reach
