"""Config folders that the doctor writes: names of files and folders."""

import errno

import pytest
import yaml
from support import strangers
from support.strangers import Y, Z

from runner.config.compose import compose
from runner.config.validation import validate
from runner.doctor.config_folder import robot_name, write_folder
from runner.doctor.examination import examine
from runner.errors import RunnerError


@pytest.fixture
def written(tmp_path):
    """What is written of an arm of a name, whose tip has a name, too."""

    def make(name, tip="tip"):
        text = strangers.chain("NAME", [("revolute", Z), ("revolute", Y), ("revolute", Y)])
        path = tmp_path / "arm.urdf"
        path.write_text(text.replace("NAME", name).replace('"tip"', f'"{tip}"'))
        with strangers.short_examination():
            examination = examine(path, None)
        return examination, write_folder(examination, tmp_path / "mine")

    return make


@pytest.mark.parametrize("tip", ["12", "yes", "tool: 3", "# end", "größe"])
def test_a_tip_of_any_name_is_taken(written, tmp_path, tip):
    _, (robot, _) = written("arm", tip)
    assert yaml.safe_load(robot.read_text())["robot"]["tip"] == tip
    config = validate(compose(["robot=arm"], [tmp_path / "mine"]).resolved, [tmp_path / "mine"])
    assert config.arm.model.tip_name == tip


@pytest.mark.parametrize(
    ("name", "file"), [("My Arm (v2)", "my_arm_v2"), ("../../evil", "evil"), ("---", "arm"), ("IRB-120", "irb_120")]
)
def test_files_are_named_plainly_and_lie_in_the_folder(written, tmp_path, name, file):
    examination, paths = written(name)
    assert robot_name(examination) == file
    assert paths == [tmp_path / "mine" / "robot" / f"{file}.yaml", tmp_path / "mine" / "robots" / f"{file}.urdf"]


def test_a_folder_that_cannot_be_made_is_told(written, tmp_path):
    (tmp_path / "mine").write_text("a file")
    with pytest.raises(RunnerError, match=r"--write: cannot write .*mine.robot.arm.yaml: .*; nothing was written"):
        written("arm")


def test_where_a_file_cannot_be_written_none_is_left(written, tmp_path, monkeypatch):
    taken = []

    def full(file):
        if taken:
            raise OSError(errno.ENOSPC, "disk full")
        taken.append(file)

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(RunnerError, match=r"cannot write .*arm.urdf: disk full; free space on its disk; nothing was"):
        written("arm")
    assert not [path for path in (tmp_path / "mine").rglob("*") if path.is_file()]
