"""The doctor on MJCF files against the same arms as URDF."""

import pytest
import yaml
from support import strangers
from support.caveat_runs import found as caveats_found
from support.mjcf_arms import CHAIN, disagreement, written

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.doctor.config_folder import write_folder
from runner.doctor.examination import examine

FINGERS = CHAIN.replace(
    '<site name="tcp"',
    '<body name="finger"><joint name="f" axis="1 0 0"/><geom size="0.01 0.1"/></body><site name="tcp"',
)


def config(folder):
    return validate(compose(["robot=elbow"], [folder]))


def test_an_mjcf_is_examined_as_a_urdf(tmp_path):
    held = CHAIN.replace("<joint ", '<joint damping="2" armature="0.1" ', 1)
    examination = examine(written(tmp_path, held.replace("<default>", '<option density="1.2"/><default>')), None)
    assert examination.arm is not None
    said = {finding.place: finding.text for finding in examination.findings}
    assert said["damping"] == "2 (q1, q2, q3)"
    assert said["armature"] == "0.1 (q1, q2, q3)"
    assert said["left out of the motion"] == "density of the air of 1.2 in SI units"
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


@pytest.mark.parametrize("format", ["mjcf", "urdf"])
def test_a_run_has_what_the_file_gives_its_joints(tmp_path, format):
    text = CHAIN if format == "mjcf" else FINGERS  # whose finger is held, which takes a URDF
    text = text.replace("<default>", '<option density="1.2"/><default>').replace(
        'name="q2"', 'name="q2" damping="2" armature="0.1" frictionloss="0.5"'
    )
    path = written(tmp_path, text.replace("<joint ", '<joint armature="0.3" ', 1))
    with strangers.short_examination():
        examination = examine(path, "tcp")
    assert [f.place for f in examination.findings if f.grade == "fixed"] == ([] if format == "mjcf" else ["joint 'f'"])
    files = write_folder(examination, tmp_path / "mine")
    assert files[1].suffix == (".xml" if format == "mjcf" else ".urdf")
    taken = config(tmp_path / "mine")
    assert taken.arm.model.joint_names == ("q1", "q2", "q3")
    assert taken.arm.model.armature.tolist() == [0.3, 0.1, 0.3]
    assert (taken.plant.friction.viscous, taken.plant.friction.coulomb) == ([0.0, 2.0, 0.0], [0.0, 0.5, 0.0])
    assert caveats_found(taken)["robot_file"].text.endswith(": density of the air of 1.2 in SI units")


HOMES = {
    "0.1 0.5 1": "the keyframe 'home' is taken",
    "0.1 0.5 3": "the keyframe 'home' is not taken: it has 'q3' at 3 rad, and its limits are -2.96706 to 2.96706",
    "0.1 0.5 0": "the keyframe 'home' is not taken: it is singular for the tip's position, or nearly so",
    "0.1 -0.4 1": "the keyframe 'home' is not taken: gravity asks for more there than the effort limits",
}


@pytest.mark.parametrize("posture", HOMES)
def test_a_keyframe_home_is_the_home_if_it_serves(tmp_path, posture):
    more = f'<keyframe><key name="home" qpos="{posture}"/></keyframe>'
    more += '<actuator><motor joint="q2" ctrlrange="-5 5"/></actuator>'
    path = written(tmp_path, CHAIN.replace("</worldbody>", f"</worldbody>{more}"))
    with strangers.short_examination():
        examination = examine(path, None)
    assert [f.text for f in examination.findings if f.place == "home"] == [HOMES[posture]]
    taken = examination.arm.start.home.tolist() == [float(value) for value in posture.split()]
    assert taken == HOMES[posture].endswith("is taken")


def test_a_gripper_joint_in_the_config_is_told(tmp_path):
    with strangers.short_examination():
        write_folder(examine(written(tmp_path, FINGERS), "tcp"), tmp_path)
    for override, told in (
        ("robot.velocity_limits={f: 1}", "robot.velocity_limits.f: it is held fixed; joints: q1, q2, q3"),
        ("robot.friction.viscous=[1,1,1,1]", "robot.friction.viscous: 4 values for 3 joints (q1, q2, q3); found "),
        ("robot.armature=[1,1,1,1]", "robot.armature: 4 values for 3 joints (q1, q2, q3); found "),
        ("robot.home=[0,0.5,1,0]", "robot.home: 4 values for 3 joints (q1, q2, q3); found "),
    ):
        with pytest.raises(ConfigError) as error:
            validate(compose(["robot=elbow", override], [tmp_path]))
        (problem,) = error.value.problems
        assert problem.startswith(told)


def test_an_mjcf_that_is_refused_is_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"arm\.xml holds ball joints: 'q2'"):
        examine(written(tmp_path, CHAIN.replace('name="q2"', 'name="q2" type="ball"')), None)
