"""MJCF files as robots: every plant takes them, and a changed file is another run."""

import pytest
import yaml
from support.mjcf_arms import CHAIN, written

import runner
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.base.paths import robots_dir
from runner.config.compose.compose import compose
from runner.reporting.playback import playback_bodies
from runner.robots.model import RobotModel

ROBOT = """\
# @package _global_
# An arm as MJCF
defaults: [{override /controller: operational_space}, {override /trajectory: quintic}]
robot: {name: elbow, mjcf: arm.xml, tip: tcp, home: [0.0, 0.5, 1.0], goal: [0.4, 0.2, 0.2]}
"""
STAGES = """\
# @package _global_
# A Mini on an arm as MJCF
defaults: [{override /controller: whole_body}, {override /trajectory: quintic}]
robot:
  name: pair
  stages:
    lower: {mjcf: arm.xml, tip: tcp, home: [0.0, 0.5, 1.0], mount: null}
    upper:
      urdf: mini.urdf
      tip: tip
      home: [0.0, 0.0, 0.0]
      mount: {frame: tcp, translation: [0.0, 0.0, 0.0], rotation: [0.0, 0.0, 0.0]}
  goal: [0.4, 0.2, 0.2]
  no_joint_error: {lower: 0.0, upper: 0.0}
"""


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A separate folder with an arm as MJCF, without and under another arm."""
    monkeypatch.chdir(tmp_path)
    written(tmp_path / "mine", CHAIN, "robots/arm.xml")
    written(tmp_path / "mine", ROBOT, "robot/elbow.yaml")
    written(tmp_path / "mine", STAGES, "robot/pair.yaml")
    return tmp_path / "mine"


@pytest.fixture
def checked(mine):
    """A checked config of a robot of that folder."""
    return lambda *overrides: validate(compose(overrides, [mine]))


@pytest.fixture
def problem(checked):
    """The one problem of a config."""

    def refuse(*overrides):
        with pytest.raises(ConfigError) as error:
            checked(*overrides)
        (told,) = error.value.problems
        return told

    return refuse


@pytest.mark.parametrize("plant", ["bullet", "rk4", "mujoco"])
def test_every_plant_takes_an_mjcf_and_the_run_needs_it_no_more(mine, plant):
    short = ("duration=0.2", "trajectory.duration=0.2", f"plant={plant}")
    run = runner.run("robot=elbow", *short, config_dirs=[mine])
    assert run.status == "ok"
    assert run.metrics["max_tracking_error"].median < 1e-3
    assert run.config["robot"]["mjcf"] == "arm.xml"
    (mine / "robots/arm.xml").unlink()
    model = RobotModel(run.urdf, run.provenance["tip_frame"])
    assert len(playback_bodies(run.urdf, model, model.usual_range)) > 0


def test_a_changed_file_is_another_run(mine):
    short = ("duration=0.01", "trajectory.duration=0.01")
    first = runner.run("robot=elbow", *short, config_dirs=[mine])
    assert runner.run("robot=elbow", *short, config_dirs=[mine]).folder == first.folder
    written(mine, CHAIN.replace('density="800"', 'density="900"'), "robots/arm.xml")
    assert runner.run("robot=elbow", *short, config_dirs=[mine]).folder != first.folder


def test_a_stage_may_be_an_mjcf(checked):
    arm = checked("robot=pair").arm
    assert arm.model.joint_names[:3] == ("q1", "q2", "q3")
    assert arm.model.nq == 6


def test_a_tool_a_payload_and_a_set_of_inertials_change_it(checked, mine):
    plain = checked("robot=elbow").arm.model
    tool = {"mass": 0.5, "centre_of_mass": [0.0, 0.0, 0.1], "inertia": [0.01, 0.01, 0.01], "tip": [0.0, 0.0, 0.2]}
    tool = str(tool | {"tip_radius": 0.01}).replace("'", "")
    borne = checked("robot=elbow", f"robot.tool={tool}", "robot.payload.mass=0.25").arm.model
    assert borne.mass == pytest.approx(plain.mass + 0.75)
    moments = dict.fromkeys(("ixx", "iyy", "izz"), 0.1) | dict.fromkeys(("ixy", "ixz", "iyz"), 0.0)
    links = {"hand": {"mass": 7.0, "centre_of_mass": [0.0, 0.0, 0.0], "inertia": moments}}
    written(mine, yaml.safe_dump({"heavy": {"source": "me", "links": links}}), "robots/arm.inertials.yaml")
    heavy = checked("robot=elbow", "robot.inertials=heavy").arm.model
    assert heavy.mass_matrix(plain.usual_range[0])[2, 2] == pytest.approx(0.1)


def test_a_file_is_given_once(problem):
    told = "robot.urdf, robot.mjcf: found {}; give one file, and null for the other"
    assert problem("robot=elbow", "robot.urdf=mini.urdf") == told.format("both, 'mini.urdf' and 'arm.xml'")
    assert problem("robot=elbow", "robot.mjcf=null") == told.format("neither")
    assert problem("robot=pair", "robot.stages.lower.mjcf=null").startswith("robot.stages.lower.urdf, robot.stages.low")


def test_each_key_takes_its_format(problem, mine):
    swapped = ("robot.mjcf=null", "robot.urdf=arm.xml")
    assert problem("robot=elbow", *swapped) == (f"robot.urdf: {mine}/robots/arm.xml is an MJCF; name it at robot.mjcf")
    assert problem("robot=elbow", "robot.mjcf=mini.urdf") == (
        f"robot.mjcf: {robots_dir()}/mini.urdf is not an MJCF: it begins with <robot>, not with <mujoco>; a URDF "
        "stands at robot.urdf"
    )


@pytest.mark.parametrize(
    ("overrides", "told"),
    [
        (("robot.mjcf=other.xml",), r"robot\.mjcf: no file 'other\.xml'; looked in .*/mine/robots, "),
        (("robot.mjcf=../arm.xml",), r"robot\.mjcf: '\.\./arm\.xml' leads out of its folder"),
        (("robot.mjcf=''",), r"robot\.mjcf: must not be empty"),
        (("robot.tip=tpc",), r"robot\.tip: no frame 'tpc' \(did you mean tcp\?\)"),
        (("robot.masses={tcp: 1}",), r"robot\.masses\.tcp: link 'tcp' is massless in arm\.xml"),
        (("robot.velocity_limits={q9: 1}",), r"robot\.velocity_limits\.q9: no such joint"),
    ],
)
def test_bad_input_is_told_with_its_key(checked, overrides, told):
    with pytest.raises(ConfigError, match=told):
        checked("robot=elbow", *overrides)


def test_what_is_wrong_with_the_arm_is_told_of_the_mjcf(checked, mine):
    branches = '<body><joint name="b" axis="1 0 0"/><geom size="0.01 0.1"/></body><body name="fore"'
    written(mine, CHAIN.replace('<body name="fore"', branches), "robots/arm.xml")
    with pytest.raises(ConfigError, match=r"robot\.mjcf: .*arm\.xml branches: b move in addition to q1, q2, q3"):
        checked("robot=elbow")
