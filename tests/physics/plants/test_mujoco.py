"""MuJoCo's plant: mass matrices against Pinocchio's, and files whose contents it must ignore."""

import re

import numpy as np
import pytest
from support import strangers

from runner.base.errors import ConfigError
from runner.plants.mujoco import Mujoco, build, default_step
from runner.robots.model import RobotModel

POINT = """
<robot name="pendulum"><link name="base"/><link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
  <inertia ixx="{across}" iyy="{across}" izz="{along}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="q1" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>{dynamics}
  <limit lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"/></joint></robot>
"""


def pendulum(across=0.0, along=0.0, dynamics=""):
    return POINT.format(across=across, along=along, dynamics=dynamics)


def make(urdf, tip, step=1e-4, steps=1, model=None, integrator="euler", min_inertia=1e-12):
    """Make MuJoCo's arm; the model may be of another string than MuJoCo reads."""
    return Mujoco(urdf, model or RobotModel(urdf, tip), step, steps, integrator, min_inertia)


@pytest.mark.parametrize("robot", ["macro", "mini", "combined", "xarm7", "meca500", *strangers.STRANGERS])
def test_masses_are_those_of_the_model(checked_config, robot):
    config = strangers.config(robot) if robot in strangers.STRANGERS else checked_config(f"robot={robot}")
    arm, draw = config.arm, np.random.default_rng(0)
    plant = make(arm.urdf, "", model=arm.model)
    lower, upper = arm.model.usual_range
    for q in 0.5 * (lower + upper) + 0.4 * (upper - lower) * draw.uniform(-1.0, 1.0, (10, arm.model.nq)):
        M = arm.model.mass_matrix(q)
        np.testing.assert_allclose(plant.mass_matrix(q), M, atol=1e-8 * np.abs(M).max() + 2e-12 * arm.model.nq)


@pytest.mark.parametrize("floor", [1e-12, 1e-8, 1e-4])
def test_a_link_without_inertia_gets_the_least_one_and_one_with_more_keeps_its_own(floor):
    assert make(pendulum(), "rod", min_inertia=floor).mass_matrix(np.zeros(1))[0, 0] == pytest.approx(
        2.0 * 0.5**2 + floor, rel=1e-15
    )
    heavy = make(pendulum(across=0.3, along=0.2), "rod", min_inertia=floor)
    assert heavy.mass_matrix(np.zeros(1))[0, 0] == pytest.approx(0.5 + 0.3, rel=1e-14)


@pytest.mark.parametrize("along", [0.6, 0.6 * (1.0 + 1e-15), 0.0])
def test_discs_and_rods_are_taken_whatever_rounding_made_of_their_moments(along):
    across = 0.3
    assert make(pendulum(across, along), "rod").mass_matrix(np.zeros(1))[0, 0] == pytest.approx(0.5 + across)


def test_damping_and_friction_of_the_file_are_left_out_as_in_the_other_engines():
    plant = make(pendulum(0.1, 0.1, '<dynamics damping="5" friction="3"/>'), "rod", step=1e-3)
    plant.set_gravity(np.zeros(3))
    plant.reset(np.zeros(1), np.array([20.0]))
    for _ in range(1000):
        plant.advance(np.zeros(1))
    assert plant.dq[0] == pytest.approx(20.0, rel=1e-12)
    assert plant.q[0] == pytest.approx(20.0, rel=1e-12)


@pytest.mark.parametrize("speed", [1e3, 1e9])
def test_no_speed_is_clamped_and_nothing_is_begun_anew(speed, capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plant = make(pendulum(0.1, 0.1), "rod", step=1e-3)
    plant.set_gravity(np.zeros(3))
    plant.reset(np.zeros(1), np.array([speed]))
    plant.advance(np.array([1e12 * 0.6]))
    assert plant.dq[0] == pytest.approx(speed + 1e9, rel=1e-9)
    plant.advance(np.array([np.nan]))
    assert np.isnan(plant.dq[0])
    assert capfd.readouterr() == ("", "")  # MuJoCo prints warnings, and writes them to a file
    assert not list(tmp_path.iterdir())


def test_what_a_file_tells_mujoco_to_do_is_left_out():
    told = '<mujoco><compiler settotalmass="50"/><option integrator="RK4"/></mujoco></robot>'
    plain, telling = (make(text, "rod") for text in (pendulum(0.1), pendulum(0.1).replace("</robot>", told)))
    np.testing.assert_array_equal(plain.mass_matrix(np.zeros(1)), telling.mass_matrix(np.zeros(1)))


def test_an_urdf_that_mujoco_refuses_is_an_error_of_one_line():
    with pytest.raises(
        ConfigError,
        match=r"robot\.urdf: MuJoCo does not accept it: Error: axis too small in joint Element name 'q1', id 0$",
    ):
        make(pendulum().replace('axis xyz="0 1 0"', 'axis xyz="0 0 0"'), "rod", model=RobotModel(pendulum(), "rod"))


def test_joints_in_another_order_are_refused():
    named = RobotModel(pendulum().replace('"q1"', '"hinge"'), "rod")
    with pytest.raises(ConfigError, match=r"MuJoCo has the joints q1, not hinge"):
        make(pendulum(), "rod", model=named)


def test_it_makes_contacts_and_feels_tools():
    plant = make(pendulum(), "rod")
    assert plant.tool_reaction() is None
    assert not plant.contact_wrench().any()


def test_build_and_default_step(checked_config, macro_urdf, one_stage):
    config = checked_config("robot=macro", "plant=mujoco").plant
    assert isinstance(build(config, one_stage(macro_urdf, RobotModel(macro_urdf, "tip")), 1e-3, 10), Mujoco)
    assert default_step(0.01, 1) == pytest.approx(0.001)
    assert default_step(0.001, 2) == pytest.approx(0.00025)


@pytest.mark.bullet
def test_the_default_step_is_that_of_bullet():
    from runner.plants import bullet

    for tick, stages in ((0.01, 1), (0.001, 2)):
        assert default_step(tick, stages) == bullet.default_step(tick, stages)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("plant.integrator=leapfrog", "plant.integrator: found 'leapfrog'; allowed: euler, rk4"),
        ("plant.min_inertia=0", "plant.min_inertia: must be 1e-12 or more; found 0"),
        ("plant.mass=1", "plant.mass: unknown key"),
    ],
)
def test_config_that_cannot_be(cli, override, message):
    ending = cli("robot=macro", "plant=mujoco", override)
    assert ending.code == 2
    assert re.search(message, ending.err), ending.err
