"""Outlines of robots: the same joints, units and limits as in the rigid-body model."""

import numpy as np
import pytest

from runner.assembly.arms import build_robot, read_outline
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose
from runner.config.parsing import group_of, parse_robot
from runner.robots.description import find_urdf

ROBOTS = sorted(path.stem for path in (conf_dir() / "robot").glob("*.yaml"))


@pytest.mark.parametrize("name", ROBOTS)
def test_an_outline_has_the_joints_of_the_model(name):
    outline = read_outline(parse_robot(group_of("robot", compose([f"robot={name}"]).resolved)))
    robot = build_robot(outline, 9.81)
    np.testing.assert_array_equal(outline.effort_limits, robot.model.effort_limits)
    assert outline.stage_names == robot.stage_names
    for arm, stage in zip(outline.stages, robot.stages, strict=True):
        assert arm.joint_names == stage.model.joint_names
        assert arm.joint_units == stage.model.joint_units
        np.testing.assert_array_equal(arm.home, stage.home)


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        ("robot.stages.mini.mount=null", "robot.stages.mini.mount: missing; a stage above the first needs frame, "),
        ("robot.stages.mini.mount.frame=q3", "robot.stages.mini.mount.frame: no link 'q3'; links: base, link1, "),
        ("robot.stages.mini.tip=tpi", "robot.tip: no frame 'tpi' (did you mean tip?); frames: base, link1, link2, "),
        ("robot.friction.viscous=[1,2]", "robot.friction.viscous: 2 values for 6 joints (q1, q2, q3, mini_q1, "),
        (
            "robot.stages.mini.home=[0,0]",
            "robot.stages.mini.home: 2 values for 3 joints (q1, q2, q3); found ",
        ),
    ],
)
def test_a_wrong_arm_is_reported_with_all_other_problems(override, problem):
    with pytest.raises(ConfigError) as raised:
        validate(compose(["robot=combined", "seed=x", "typo=1", override]))
    typo, seed, arm = raised.value.problems
    assert typo.startswith("typo: unknown key")
    assert seed.startswith("seed: must be")
    assert arm.startswith(problem)


@pytest.mark.parametrize("home", ["[0,0,0]", "[0,0.5,0]"])
def test_a_continuous_joint_is_named_as_such_wherever_it_starts(tmp_path, home):
    urdf = find_urdf("macro.urdf").read_text().replace('name="q2" type="revolute"', 'name="q2" type="continuous"')
    (tmp_path / "robot").mkdir()
    (tmp_path / "endless.urdf").write_text(urdf)
    text = (conf_dir() / "robot" / "macro.yaml").read_text()
    (tmp_path / "robot" / "endless.yaml").write_text(text.replace("macro", "endless"))
    with pytest.raises(ConfigError) as raised:
        validate(compose(["robot=endless", f"robot.home={home}"], [tmp_path]))
    assert list(raised.value.problems) == [
        f"robot.urdf: joint 'q2' in {tmp_path / 'endless.urdf'} is continuous; allowed: revolute or prismatic; "
        "`runner doctor FILE --output DIR` makes a continuous joint revolute"
    ]


def test_a_file_that_changed_is_read_anew(tmp_path):
    file, urdf = tmp_path / "macro.urdf", find_urdf("macro.urdf").read_text()
    file.write_text(urdf)
    config = parse_robot(group_of("robot", compose(["robot=macro", f"robot.urdf={file}"]).resolved))
    before = build_robot(read_outline(config), 9.81)
    file.write_text(urdf.replace("</joint>", '<dynamics damping="7.0"/></joint>', 1))
    after = build_robot(read_outline(config), 9.81)
    assert (before.stages[0].file.damping[0], after.stages[0].file.damping[0]) == (0.0, 7.0)


def test_a_payload_is_on_the_arm_of_the_same_file():
    masses = []
    for payload in (0.0, 1.5):
        config = parse_robot(group_of("robot", compose(["robot=panda", f"robot.payload.mass={payload}"]).resolved))
        bodies = build_robot(read_outline(config), 9.81).model.pin_model.inertias
        masses.append(sum(body.mass for body in bodies))
    assert masses[1] - masses[0] == pytest.approx(1.5)
