"""Config folders that the doctor writes: names of files and folders."""

import errno
import re

import pytest
import yaml
from support import strangers
from support.strangers import Y, Z

import runner
from runner.assembly.validation import validate
from runner.base.errors import ConfigError, RunnerError
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose
from runner.config.compose.files import group_options
from runner.doctor.config_folder import write_folder
from runner.doctor.examination import examine
from runner.robots.description import find_urdf

OURS = sorted(group_options("robot"))


@pytest.fixture
def written(tmp_path):
    """The config folder that is written for an arm in a file; its tip also has a name."""

    def make(file, tip="tip", name=None):
        text = strangers.chain(
            "model" if "scene" in file else "header", [("revolute", Z), ("revolute", Y), ("revolute", Y)]
        )
        path = tmp_path / file
        path.parent.mkdir(exist_ok=True)
        path.write_text(text.replace('"tip"', f'"{tip}"'))
        with strangers.short_examination():
            examination = examine(path, None, name)
        return examination, write_folder(examination, tmp_path / "mine")

    return make


@pytest.mark.parametrize("tip", ["12", "yes", "tool: 3", "# end", "größe"])
def test_a_tip_of_any_name_is_taken(written, tmp_path, tip):
    _, (robot, _) = written("lamp.urdf", tip)
    assert yaml.safe_load(robot.read_text())["robot"]["tip"] == tip
    config = validate(compose(["robot=lamp"], [tmp_path / "mine"]))
    assert config.arm.model.tip_name == tip


@pytest.mark.parametrize(
    ("file", "wanted", "name"),
    [
        ("My Arm (v2).urdf", None, "my_arm_v2"),
        ("IRB-120.urdf.urdf", None, "irb_120"),
        ("jib/robot.urdf", None, "header"),
        ("jib/scene.urdf", None, "jib"),
        ("lamp.urdf", "desk_2", "desk_2"),
        ("xarm7.urdf", None, "my_xarm7"),
        ("6700.urdf", None, "arm_6700"),
        ("no.urdf", None, "arm_no"),
    ],
)
def test_files_are_named_by_the_file_or_its_folder_or_as_wished(written, tmp_path, file, wanted, name):
    examination, paths = written(file, name=wanted)
    assert examination.name == name
    assert paths == [tmp_path / "mine" / "robot" / f"{name}.yaml", tmp_path / "mine" / "robots" / f"{name}.urdf"]


@pytest.mark.parametrize(
    ("name", "said"), [("xarm7", "one of our robots"), ("../x", "allowed: "), ("", "allowed: "), ("7", "allowed: ")]
)
def test_a_name_of_ours_or_of_other_letters_is_refused(written, name, said):
    with pytest.raises(RunnerError, match=f"--name: '{name}'.*{said}"):
        written("lamp.urdf", name=name)


@pytest.mark.parametrize("ours", OURS)
def test_the_command_printed_runs_the_arm_that_was_examined(written, tmp_path, ours):
    examination, (_, urdf) = written(f"{ours}.urdf")
    composed = compose([f"robot={examination.name}"], [tmp_path / "mine"])
    assert find_urdf(composed.resolved["robot"]["urdf"], composed.config_dirs) == urdf
    assert urdf.read_text() == f"{examination.urdf}\n"


@pytest.mark.parametrize("ours", OURS)
def test_no_robot_of_a_folder_has_the_name_of_one_of_ours(tmp_path, ours):
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot" / f"{ours}.yaml").write_text("# @package _global_\nrobot: {urdf: lamp.urdf}\n")
    with pytest.raises(
        ConfigError, match=rf"robot: '{ours}' is a built-in option, and .*/robot/{ours}\.yaml has the same name"
    ):
        compose([f"robot={ours}"], [tmp_path])


def test_other_robots_of_such_a_folder_are_as_they_were(tmp_path):
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot" / "xarm7.yaml").write_text("robot: {urdf: lamp.urdf}\n")
    assert compose(["robot=mini"], [tmp_path]).choices["robot"] == "mini"


@pytest.mark.parametrize("ours", OURS)
def test_no_robot_of_ours_takes_its_arm_from_a_folder(tmp_path, ours):
    robot = yaml.safe_load((conf_dir() / "robot" / f"{ours}.yaml").read_text())["robot"]
    for arm in filter(lambda arm: "urdf" in arm, robot.get("stages", {"": robot}).values()):
        (tmp_path / arm["urdf"]).write_text(strangers.chain("other", [("revolute", Z), ("revolute", Y)]))
        with pytest.raises(ConfigError, match=rf"'{arm['urdf']}' of robot={ours} is one of ours, and "):
            compose([f"robot={ours}"], [tmp_path])


def test_an_arm_without_mass_runs_as_it_is_written_and_refuses_torques(tmp_path):
    text = strangers.chain("lamp", [("revolute", Z), ("revolute", Y), ("revolute", Y)])
    (tmp_path / "lamp.urdf").write_text(re.sub("<inertial>.*?</inertial>", "", text))
    with strangers.short_examination():
        write_folder(examine(tmp_path / "lamp.urdf"), tmp_path / "mine")
    run = runner.run("robot=lamp", "duration=0.2", config_dirs=tmp_path / "mine", outputs=tmp_path / "outputs")
    assert (run.status, run.config["plant"]["kind"]) == ("ok", "kinematic")
    assert run.metrics["max_tracking_error"].median < 1e-6
    torques = compose(["robot=lamp", "controller=computed_torque", "plant=mujoco"], [tmp_path / "mine"])
    with pytest.raises(
        ConfigError, match=r"robot: no mass behind q1, q2, q3, so torques cannot move it; .* plant=kinem"
    ):
        validate(torques)


def test_a_folder_that_cannot_be_made_is_told(written, tmp_path):
    (tmp_path / "mine").write_text("a file")
    with pytest.raises(RunnerError, match=r"--output: cannot write .*mine.robot.lamp.yaml: .*; nothing was written"):
        written("lamp.urdf")


def test_where_a_file_cannot_be_written_none_is_left(written, tmp_path, monkeypatch):
    taken = []

    def full(file):
        if taken:
            raise OSError(errno.ENOSPC, "disk full")
        taken.append(file)

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(RunnerError, match=r"cannot write .*lamp.urdf: disk full; free space on its disk; nothing was"):
        written("lamp.urdf")
    assert not [path for path in (tmp_path / "mine").rglob("*") if path.is_file()]
