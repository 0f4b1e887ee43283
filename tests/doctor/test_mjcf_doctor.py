"""The doctor on MJCF files against the same arms as URDF."""

import pytest
import yaml
from support import strangers
from support.mjcf_arms import CHAIN, disagreement, written

from runner.config.compose import compose
from runner.config.validation import validate
from runner.doctor.config_folder import write_folder
from runner.doctor.examination import examine
from runner.doctor.finding import exit_code
from runner.errors import ConfigError

FINGERS = CHAIN.replace(
    '<site name="tcp"',
    '<body name="finger"><joint name="f" axis="1 0 0"/><geom size="0.01 0.1"/></body><site name="tcp"',
)


def config(folder):
    return validate(compose(["robot=elbow"], [folder]).resolved, [folder])


def test_an_mjcf_is_examined_as_a_urdf(tmp_path):
    examination = examine(written(tmp_path, CHAIN.replace("<joint ", '<joint damping="2" ', 1)), None)
    assert exit_code(examination.findings) == 0
    said = {finding.place: finding.text for finding in examination.findings}
    assert said["left out of the motion"] == "damping (plant.friction.viscous): 2 (q1, q2, q3)"
    assert said["left out"].startswith("shapes (3)")
    assert sum(finding.place == "engines" for finding in examination.findings) == 2


def test_a_folder_takes_the_mjcf_with_its_files(tmp_path):
    text = CHAIN.replace("<worldbody>", '<include file="parts/more.xml"/><worldbody>')
    written(tmp_path, '<mujocoinclude><option timestep="0.001"/></mujocoinclude>', "parts/more.xml")
    with strangers.short_examination():
        examination = examine(written(tmp_path, text), None)
    folder = tmp_path / "mine"
    files = write_folder(examination, folder)
    assert [file.relative_to(folder).as_posix() for file in files] == [
        "robot/elbow.yaml", "robots/arm.xml", "robots/parts/more.xml"
    ]  # fmt: skip
    assert yaml.safe_load(files[0].read_text())["robot"]["mjcf"] == "arm.xml"
    assert config(folder).arm.model.tip_name == "tcp"
    assert disagreement(files[1], "tcp") < 1e-10


def test_joints_beside_the_tip_are_held_fixed_in_a_urdf(tmp_path):
    path = written(tmp_path, FINGERS)
    with strangers.short_examination():
        examination = examine(path, "tcp")
    (mended,) = [finding for finding in examination.findings if finding.mended]
    assert mended.place == "joint 'f'"
    folder = tmp_path / "mine"
    files = write_folder(examination, folder)
    assert files[1] == folder / "robots" / "elbow.urdf"
    assert config(folder).arm.model.joint_names == ("q1", "q2", "q3")


def test_an_mjcf_that_is_refused_is_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"arm\.xml holds ball joints: 'q2'"):
        examine(written(tmp_path, CHAIN.replace('name="q2"', 'name="q2" type="ball"')), None)
