"""Robots of ten lines: defaults fill in what a file leaves out, and its own values win."""

import pytest
import yaml

import runner
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose
from runner.config.robot import ArmConfig, OneArmConfig

DEFAULTS = yaml.safe_load((conf_dir() / "robot_defaults.yaml").read_text())["robot"]
ONE_ARM = """\
# @package _global_
# A Macro of ten lines
defaults:
  - override /trajectory: quintic
robot:
  name: plain
  urdf: macro.urdf
  tip: tip
  home: [0.0, 0.3, -0.6]
  goal: [0.4, 1.1, 0.9]
"""
TWO_ARMS = """\
# @package _global_
robot:
  name: pair
  stages:
    lower: {urdf: macro.urdf, tip: tip, home: [0.0, 0.0, 0.0]}
    upper:
      urdf: mini.urdf
      tip: tip
      home: [0.0, 0.0, 0.0]
      armature: 1.0e-6
      mount: {frame: tip, translation: [0.0, 0.0, 0.0], rotation: [0.0, 0.0, 0.0]}
  goal: [0.4, 1.1, 0.9]
controller: {kind: whole_body}
"""


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A user's folder with short robots."""
    monkeypatch.chdir(tmp_path)
    for name, text in (("plain", ONE_ARM), ("pair", TWO_ARMS)):
        (tmp_path / f"mine/robot/{name}.yaml").parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / f"mine/robot/{name}.yaml").write_text(text)
    return tmp_path / "mine"


def test_a_robot_of_ten_lines_runs(mine):
    assert len(ONE_ARM.splitlines()) == 10
    run = runner.run("robot=plain", config_dirs=[mine])
    assert run.status == "ok"
    assert {key: run.config["robot"][key] for key in DEFAULTS} == DEFAULTS | {"urdf": "macro.urdf"}
    assert run.config["controller"]["natural_frequency"] == DEFAULTS["natural_frequency"]


@pytest.mark.parametrize("group", ["noise=thesis", "torque_limits=thesis", "trajectory=circle"])
def test_other_groups_take_the_defaults(mine, group):
    validate(compose(["robot=plain", group], [mine]))


def test_what_its_file_says_wins(mine):
    resolved = compose(["robot=plain", "robot.period=0.002"], [mine]).resolved
    assert resolved["controller"]["period"] == 0.002
    assert compose(["robot=macro"]).resolved["robot"]["settling_band"] == 0.02


def test_what_has_no_default_is_missed(mine):
    (mine / "robot/plain.yaml").write_text(ONE_ARM.replace("  tip: tip\n", "").replace("  goal: [0.4, 1.1, 0.9]\n", ""))
    with pytest.raises(ConfigError) as raised:
        validate(compose(["robot=plain", "trajectory=circle"], [mine]))
    assert raised.value.problems == ("robot.tip: missing", "robot.goal: missing")


def test_every_key_of_a_robot_has_a_default_or_must_be_given():
    given = {"name", "tip", "home", "goal"}
    assert set(DEFAULTS) == set(OneArmConfig.model_fields) - given


def test_each_stage_takes_the_defaults_of_an_arm(mine):
    robot = compose(["robot=pair"], [mine]).resolved["robot"]
    of_arm = {key: DEFAULTS[key] for key in DEFAULTS if key in ArmConfig.model_fields}
    assert set(of_arm) == {"urdf", "mjcf", "inertials", "masses", "armature", "velocity_limits"}
    assert {key: robot["stages"]["lower"][key] for key in of_arm} == of_arm | {"urdf": "macro.urdf"}
    assert robot["stages"]["upper"]["armature"] == 1e-6
    assert not set(of_arm) & set(robot)


def test_a_value_of_one_arm_is_refused_for_a_robot_of_several():
    with pytest.raises(ConfigError, match=r"robot.armature: unknown key"):
        validate(compose(["robot=combined", "robot.armature=0.1"]))


@pytest.mark.parametrize("robot", ["macro", "combined", "xarm7", "meca500"])
def test_our_own_robots_are_as_their_files_say(robot):
    said = yaml.safe_load((conf_dir() / f"robot/{robot}.yaml").read_text())["robot"]
    friction = DEFAULTS["friction"] | said["friction"]
    assert compose([f"robot={robot}"]).resolved["robot"] == said | {"friction": friction}
