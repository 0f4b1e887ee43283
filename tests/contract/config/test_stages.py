"""Values by stage: overrides of one stage, mappings that merge, and what is refused with the stages' names."""

import pytest
import yaml

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose

COMBINED = ("robot=combined", "noise=thesis", "torque_limits=thesis")
SECOND_MINI = {
    "urdf": "mini.urdf",
    "tip": "tip",
    "home": [0.0, 0.0, 0.0],
    "inertials": None,
    "masses": {},
    "armature": 0.0,
    "velocity_limits": {},
    "mount": {"frame": "tip", "translation": [0.0, 0.0, 0.0], "rotation": [0.0, 0.0, 0.0]},
}


def resolve(*overrides):
    return compose([*COMBINED, *overrides]).resolved


def problems(*overrides, config_dirs=()):
    composed = compose(overrides, config_dirs)
    with pytest.raises(ConfigError) as raised:
        validate(composed)
    return raised.value.problems


@pytest.mark.parametrize(
    ("override", "group", "key", "expected"),
    [
        ("controller.period.macro=0.03", "controller", "period", {"macro": 0.03, "mini": 0.001}),
        ("controller.natural_frequency.mini=200", "controller", "natural_frequency", {"macro": 30.0, "mini": 200}),
        ("noise.position.mini=1e-4", "noise", "position", {"macro": 1e-3, "mini": 1e-4}),
        ("noise.position={macro: 2e-3}", "noise", "position", {"macro": 2e-3, "mini": 1e-5}),
        ("noise.position={macro: 0, mini: 0}", "noise", "position", {"macro": 0, "mini": 0}),
        ("torque_limits.max.macro=40", "torque_limits", "max", {"macro": 40, "mini": 5.0}),
        ("torque_limits.max.macro=[40,30,20]", "torque_limits", "max", {"macro": [40, 30, 20], "mini": 5.0}),
        ("robot.period.macro=0.02", "controller", "period", {"macro": 0.02, "mini": 0.001}),
        ("robot.stages.mini.masses.link2=0.2", "robot", "stages", None),
    ],
)
def test_one_stage_is_changed_and_the_others_keep_theirs(override, group, key, expected):
    composed = compose([*COMBINED, override])
    resolved = composed.resolved
    if expected is not None:
        assert resolved[group][key] == expected
    else:
        stages = resolved[group][key]
        assert stages["mini"]["masses"] == {"link2": 0.2, "link3": 0.1}
        assert stages["macro"]["masses"] == {"link2": 1.0, "link3": 1.0}
    config = validate(composed)
    assert config.arm.stage_names == ("macro", "mini")


def test_two_stages_changed_apart_merge():
    resolved = resolve("controller.period.macro=0.02", "controller.period.mini=0.002", "noise.position.macro=1e-4")
    assert resolved["controller"]["period"] == {"macro": 0.02, "mini": 0.002}
    assert resolved["noise"]["position"] == {"macro": 1e-4, "mini": 1e-5}


def test_without_noise_one_stage_may_have_some():
    resolved = compose(["robot=combined", "noise.position.mini=1e-4"]).resolved
    assert resolved["noise"]["position"] == {"macro": 0.0, "mini": 1e-4}


def test_limits_reach_the_joints_of_their_stage(closed_loop):
    loop = closed_loop(*COMBINED, "torque_limits.max.macro=[40,30,20]", "trajectory=quintic")
    assert loop.limits.max.tolist() == [40.0, 30.0, 20.0, 5.0, 5.0, 5.0]


def test_the_tick_is_the_fastest_stage_s(checked_config):
    config = checked_config("robot=combined", "controller.period.macro=0.03", "controller.period.mini=0.003")
    assert config.timing.tick == 0.003
    assert config.timing.step == pytest.approx(0.003 / 4)
    reverse = checked_config("robot=combined", "controller.period.macro=0.001", "controller.period.mini=0.005")
    assert reverse.timing.tick == 0.001


@pytest.mark.parametrize(
    ("overrides", "problem"),
    [
        (
            "controller.period=0.01",
            "controller.period: needs a value for each stage (macro, mini); found 0.01 for all",
        ),
        ("noise.position=1e-3", "noise.position: needs a value for each stage (macro, mini); found 0.001 for all"),
        ("torque_limits.max=40", "torque_limits.max: needs a value for each stage (macro, mini); found 40.0 for all"),
        (
            "controller.damping_ratio=1",
            "controller.damping_ratio: needs a value for each stage (macro, mini); found 1.0 for all",
        ),
        ("noise.position.mimi=1", "noise.position.mimi: no such stage (did you mean mini?); stages: macro, mini"),
        (
            "controller.period.makro=1",
            "controller.period.makro: no such stage (did you mean macro?); stages: macro, mini",
        ),
        ("noise.position.mini=-1", "noise.position: mini must be 0 or more; found {'macro': 0.001, 'mini': -1}"),
        (
            "controller.period.macro=abc",
            "controller.period: macro must be a number; found {'macro': 'abc', 'mini': 0.001}",
        ),
        (
            "controller.period.macro=0.0105",
            "controller.period.macro: 0.0105 s is not a multiple of the fastest loop's, controller.period.mini with "
            "0.001 s",
        ),
        (
            "controller.period.mini=0.004",
            "controller.period.macro: 0.01 s is not a multiple of the fastest loop's, controller.period.mini with "
            "0.004 s",
        ),
        (
            "torque_limits.max.mini=[5,5]",
            "torque_limits.max.mini: 2 values for 3 joints (q1, q2, q3); found [5.0, 5.0]",
        ),
        (
            "robot.stages.mini.mount.frame=tpi",
            "robot.stages.mini.mount.frame: no link 'tpi' (did you mean tip?); links: base, link1, link2, link3, tip",
        ),
        (
            "robot.stages.mini.home=[0,0]",
            "robot.stages.mini.home: 2 values for 3 joints (q1, q2, q3); found [0.0, 0.0]",
        ),
        (
            "trajectory.goal=[1,2,2]",
            "trajectory.goal: [1.0, 2.0, 2.0] m is outside the workspace: 3 m from the shoulder, and the arm reaches "
            "2.2 m",
        ),
        (
            "controller=operational_space",
            "controller.kind: operational_space controls one arm; the robot has 6 joints in stages (macro, mini); "
            "take macro_mini or whole_body",
        ),
    ],
)
def test_what_does_not_fit_two_stages_is_said_with_their_names(overrides, problem):
    assert problems(*COMBINED, *overrides.split(" ")) == (problem,)


def test_a_stage_without_a_torque_limit_is_named():
    found = problems("robot=combined", "torque_limits.max.macro=40")
    assert found == ("torque_limits.max.mini: missing; stages: macro, mini",)


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        ("noise.position.macro=1", "noise.position: the robot has one stage (macro) and takes one value; found "),
        ("torque_limits.max.mini=1", "torque_limits.max: the robot has one stage (macro) and takes one value; found "),
        (
            "controller.period.macro=0.03",
            "controller.period: the robot has one stage (macro) and takes one value; found ",
        ),
        (
            "controller.natural_frequency.mini=3",
            "controller.natural_frequency: the robot has one stage (macro) and takes one value; found ",
        ),
        ("controller=macro_mini", "controller.kind: macro_mini couples stages and the robot has one (macro); take "),
    ],
)
def test_stages_of_a_robot_that_has_one_are_refused(override, problem):
    (found,) = problems("robot=macro", override)
    assert found.startswith(problem)


@pytest.fixture
def own_robot(tmp_path):
    """Write a user's robot: the combined one with other stages."""

    def write(change):
        content = yaml.safe_load((conf_dir() / "robot" / "combined.yaml").read_text())
        change(content["robot"])
        (tmp_path / "robot").mkdir()
        (tmp_path / "robot" / "mine.yaml").write_text(
            f"# @package _global_\n{yaml.safe_dump(content, sort_keys=False)}"
        )
        return [tmp_path]

    return write


def test_names_that_clash_between_stages_are_said(own_robot, tmp_path):
    # A stage's names start with its own: the second one's "link_base" is in the first arm already.
    urdf = """<robot name="odd"><link name="{0}base">{1}</link><link name="{0}arm">{1}</link>
      <joint name="q" type="revolute"><parent link="{0}base"/><child link="{0}arm"/><axis xyz="0 0 1"/>
      <limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>"""
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    (tmp_path / "odd.urdf").write_text(urdf.format("link_", inertial))
    (tmp_path / "plain.urdf").write_text(urdf.format("", inertial))

    def change(robot):
        lower, upper = robot["stages"]["macro"], robot["stages"].pop("mini")
        lower |= {"urdf": "odd.urdf", "tip": "link_arm", "home": [0.0], "masses": {}}
        upper |= {"urdf": "plain.urdf", "tip": "arm", "home": [0.0], "masses": {}}
        upper["mount"]["frame"] = "link_arm"
        robot["stages"]["link"] = upper

    found = problems("robot=mine", config_dirs=own_robot(change))
    assert (
        "robot.stages.link: the link name link_arm stands in the carrying arm already; name the stage differently"
        in found
    )


def test_a_stage_that_the_values_leave_out_is_named(own_robot):
    def change(robot):
        robot["stages"]["top"] = SECOND_MINI

    found = problems("robot=mine", config_dirs=own_robot(change))
    assert "noise.position.top: missing; stages: macro, mini, top" in found
    assert "controller.period.top: missing; stages: macro, mini, top" in found


def test_a_staged_robot_needs_two_stages(own_robot):
    found = problems("robot=mine", config_dirs=own_robot(lambda robot: robot["stages"].pop("mini")))
    assert any(problem.startswith("robot.stages: ") for problem in found)


def test_all_problems_of_stages_are_said_at_once():
    found = problems(*COMBINED, "noise.position=1", "torque_limits.max.mimi=1", "controller.period.macro=0.0105")
    assert [problem.split(":")[0] for problem in found] == [
        "noise.position",
        "torque_limits.max.mimi",
        "controller.period.macro",
    ]
