"""Rotor inertias: the model against the stated rule and against the engines."""

import numpy as np
import pytest
import yaml
from support.arms import checked

from runner.config.compose import compose
from runner.config.validation import validate
from runner.errors import ConfigError
from runner.plants.mujoco import Mujoco
from runner.plants.rk4 import Rk4
from runner.robots import RobotModel, find_urdf, read_urdf
from runner.robots.rotors import rotor_file

EFFORT_TO_INERTIA = 0.008  # s^2: N times 8e-5 kg m^2 for each N m of motor torque, with N = 100


def model_of(rotor_inertia, urdf="xarm7.urdf"):
    return RobotModel(read_urdf(find_urdf(urdf), {}, rotor_inertia), "flange")


def added_about_axes(model, plain):
    """Return what each joint's own link has more about the joint's axis, the largest moment of a disc."""
    pairs = zip(list(model.pin_model.inertias)[1:], list(plain.pin_model.inertias)[1:], strict=True)
    return np.array([np.linalg.eigvalsh(more.inertia - less.inertia)[2] for more, less in pairs])


@pytest.mark.parametrize("robot", ["xarm7", "meca500"])
def test_the_assumed_rotors_follow_the_stated_rule(checked_config, robot):
    plain, geared = (
        checked_config(f"robot={robot}", *more).arm.model for more in ((), ("robot.rotor_inertia=assumed",))
    )
    np.testing.assert_allclose(added_about_axes(geared, plain), EFFORT_TO_INERTIA * plain.effort_limits, rtol=1e-9)


def test_one_value_is_one_for_each():
    q = np.linspace(-0.5, 0.7, 7)
    np.testing.assert_array_equal(model_of([0.1] * 7).mass_matrix(q), model_of(0.1).mass_matrix(q))


def test_the_last_joint_feels_its_own_rotor_alone():
    q = np.linspace(-0.5, 0.7, 7)
    more = model_of([0.0] * 6 + [0.2]).mass_matrix(q) - model_of(0.0).mass_matrix(q)
    assert more[6, 6] == pytest.approx(0.2, rel=1e-12)
    more = model_of([0.3] + [0.0] * 6).mass_matrix(q) - model_of(0.0).mass_matrix(q)
    np.testing.assert_allclose(more, np.diag([0.3] + [0.0] * 6), atol=1e-15)


@pytest.mark.parametrize("robot", ["xarm7", "meca500"])
def test_plants_agree_with_the_model(checked_config, robot):
    arm, h = checked_config(f"robot={robot}", "robot.rotor_inertia=assumed").arm, 1e-5
    q, tau = arm.home + 0.1, np.linspace(1.0, 2.0, arm.model.nq)
    expected = arm.model.forward_dynamics(q, np.zeros_like(q), tau)
    for make in (lambda: Rk4(arm.model, h, 1), lambda: Mujoco(arm.urdf, arm.model, h, 1, "euler", 1e-9)):
        plant = make()
        plant.reset(q, np.zeros_like(q))
        plant.advance(tau)
        np.testing.assert_allclose(plant.dq / h, expected, atol=1e-4 * np.abs(expected).max())
        plant.close()


@pytest.mark.bullet
@pytest.mark.parametrize("robot", ["xarm7", "meca500"])
def test_bullet_agrees_with_the_model(checked_config, robot, capfd):
    from runner.plants.bullet import Bullet

    arm, h = checked_config(f"robot={robot}", "robot.rotor_inertia=assumed").arm, 1e-5
    q, tau = arm.home + 0.1, np.linspace(1.0, 2.0, arm.model.nq)
    plant = Bullet(arm.urdf, arm.model, h, 1)
    try:
        plant.reset(q, np.zeros_like(q))
        plant.advance(tau)
        expected = arm.model.forward_dynamics(q, np.zeros_like(q), tau)
        np.testing.assert_allclose(plant.dq / h, expected, atol=1e-4 * np.abs(expected).max())
    finally:
        plant.close()
    assert "Bad inertia" not in "".join(capfd.readouterr())


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
def test_what_is_no_rotor_is_refused(value, problem):
    with pytest.raises(ConfigError, match=rf"robot.rotor_inertia: {problem}"):
        checked("robot=xarm7", f"robot.rotor_inertia={value}")


def test_an_arm_without_sets_says_so():
    with pytest.raises(ConfigError, match=r"no set 'assumed'; there is no macro.rotors.yaml"):
        checked("robot=macro", "robot.rotor_inertia=assumed")


def test_a_set_of_one_s_own(tmp_path, macro_urdf):
    path = tmp_path / "arm.urdf"
    path.write_text(macro_urdf)
    rotor_file(path).write_text(yaml.safe_dump({"mine": {"source": "me", "joints": {"q9": 0.1}}}))
    with pytest.raises(ConfigError, match=r"set 'mine' names the joint 'q9', which arm.urdf does not have.*; joints: "):
        read_urdf(path, {}, "mine")
    rotor_file(path).write_text("mine: {source: me, joints: {q1: -1}}")
    with pytest.raises(ConfigError, match=r"arm.rotors.yaml: mine.joints.q1: .*; found -1"):
        read_urdf(path, {}, "mine")
    rotor_file(path).write_text("mine: [")
    with pytest.raises(ConfigError, match=r"arm.rotors.yaml cannot be read"):
        read_urdf(path, {}, "mine")


def test_a_quantity_with_its_unit_is_a_number():
    resolved = compose(["robot=xarm7", "robot.rotor_inertia='0.1kg m^2'"]).resolved
    assert validate(resolved).arm.urdf == checked("robot=xarm7", "robot.rotor_inertia=0.1").arm.urdf
