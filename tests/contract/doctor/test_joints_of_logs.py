"""`runner doctor LOG` on logs with other joints than the robot's: of a hand, of two arms, of another robot."""

import numpy as np
import pandas as pd
import pytest
from support import log_files as made
from support import strangers

from runner.assembly.validation import validate
from runner.base.errors import RunnerError
from runner.config.compose.compose import compose
from runner.doctor.log import examine_log
from runner.doctor.log_names import joints_by_name
from runner.robots.model import RobotModel

SIX = [f"joint{place}" for place in range(1, 7)]
ROS = {"t": "t", "q": "{}.position", "tau": "{}.effort"}


@pytest.fixture(scope="module")
def panda():
    return validate(compose(["robot=panda"])).arm.model


@pytest.fixture(scope="module")
def of_panda(panda):
    return made.arm_signals(panda)


def with_hand(signals, prefix, hand):
    """Return a table as a driver of a Panda with its hand publishes it; the fingers have no torque."""
    table = made.frame(signals, ROS)
    table.columns = [f"{prefix}{int(c[0]) + 1}{c[1:]}" if "." in c else c for c in table.columns]
    fingers = {f"{hand}{k}.{kind}": 0.01 * k for k in (1, 2) for kind in ("position", "effort")}
    return table.assign(**fingers)


@pytest.mark.parametrize(
    ("prefix", "hand"), [("panda_joint", "panda_finger_joint"), ("joint", "finger_joint"), ("joint", "hand_joint")]
)
def test_the_joints_of_a_hand_are_no_second_arm(tmp_path, panda, of_panda, prefix, hand):
    table = with_hand(of_panda, prefix, hand)
    fingers_first = table[[table.columns[0], *reversed(table.columns[1:])]]
    for each in (table, fingers_first):
        found = examine_log(made.write(tmp_path, each), panda)
        assert found.recording.positions(panda.joint_names) == pytest.approx(of_panda["q"])
        assert not any(hand in one.column for one in found.meanings)
        assert len(found.recording.of_kind("torque")) == 7


def test_a_torque_that_is_missing_does_not_make_the_hand_an_arm(tmp_path, panda, of_panda):
    table = with_hand(of_panda, "panda_joint", "panda_finger_joint").drop(columns="panda_joint7.effort")
    assert len(examine_log(made.write(tmp_path, table), panda).recording.of_kind("torque")) == 6


def of_arms(*prefixes, joints=SIX):
    return [f"{prefix}{joint}" for prefix in prefixes for joint in joints]


@pytest.mark.parametrize(
    ("labels", "joints", "wanted", "twice"),
    [
        (of_arms("left_", "right_"), SIX, 12, 12),
        (of_arms("", "right_"), SIX, 12, 12),
        (of_arms("left_", "right_")[1:-1], SIX, 10, 8),  # neither arm is complete
        (of_arms("left_", "right_")[1:], SIX, 6, 0),
        ([*of_arms("", "finger_", joints=SIX[:2])], SIX[:2], 2, 0),
        (of_arms("a_", "b_", joints=SIX[:2]), SIX[:2], 4, 4),
        (["base_joint1", "arm_joint2", "arm_joint3"], SIX[:3], 3, 0),
        (["base_joint1", *of_arms("arm_")[1:], "tool_joint2"], SIX, 6, 0),
        (of_arms("x_", joints=[*SIX, "finger_joint1"]), [*SIX, "finger_joint1"], 7, 0),
        (["left-joint1", "left_joint1", "left_joint2"], SIX[:2], 3, 2),
        (["left-joint1", "left_joint1"], SIX[:2], 2, 2),
    ],
)
def test_labels_of_one_arm_have_its_joints(labels, joints, wanted, twice):
    known, doubled = joints_by_name(labels, joints)
    assert (len(known), len(doubled)) == (wanted, twice)
    assert all(label.endswith(joint) for label, joint in known.items())


def test_two_whole_arms_are_refused(tmp_path, panda, of_panda):
    table = with_hand(of_panda, "left_joint", "left_finger_joint")
    both = table.assign(**{c.replace("left", "right"): table[c] for c in table.columns if c.startswith("left")})
    with pytest.raises(RunnerError, match="holds two arms: left_joint1, left_joint2, "):
        examine_log(made.write(tmp_path, both), panda)


@pytest.mark.parametrize("name", ["{}.effort", "/joint_states/{}/effort"])
def test_a_force_of_a_prismatic_joint_is_in_newtons(tmp_path, name):
    """A gantry, whose forces a program's table and not the column's name gives."""
    gantry = RobotModel(strangers.MADE["gantry"], "tip")
    t = np.arange(0.0, 4.0, 0.01)
    position = name.replace("effort", "position")
    table = pd.DataFrame({"time": t})
    for place, joint in enumerate(gantry.joint_names):
        table[position.format(joint)] = 0.2 * np.sin((1.0 + place) * t)
        table[name.format(joint)] = 20.0 * np.cos(t)
    found = examine_log(made.write(tmp_path, table), gantry)
    assert {one.keys["unit"] for one in found.meanings if "torque" in one.keys} == {"N"}
    assert not any("is not known" in finding.text for finding in found.findings)
    said = table.rename(columns={name.format(joint): f"{joint}_effort [Nm]" for joint in gantry.joint_names})
    said = said.rename(columns={position.format(joint): joint for joint in gantry.joint_names})
    assert "its unit 'N m' is not known" in str(examine_log(made.write(tmp_path, said), gantry).questions)


@pytest.mark.parametrize("unit", [1.0, 1.0 + 1e-12])
def test_commands_that_repeat_the_measured_positions_are_none(tmp_path, arm, signals, unit):
    copied = made.frame({**signals, "command": unit * signals["q"]}, made.RTDE)
    found = examine_log(made.write(tmp_path, copied), arm)
    said = "target_q_0 to target_q_5 repeat the measured positions: they are no commands"
    assert [str(finding) for finding in found.findings if "commands" in finding.place] == [f"note    commands: {said}"]
    assert said in found.motion.notes
    assert not found.motion.commanded
    assert not found.recording.of_kind("reference")


def test_a_single_command_that_repeats_leaves_no_motion_of_commands(tmp_path, arm, signals):
    commands = signals["command"].copy()
    commands[:, 2] = signals["q"][:, 2]
    found = examine_log(made.write(tmp_path, made.frame({**signals, "command": commands}, made.RTDE)), arm)
    assert found.motion.notes[-1].startswith(
        "target_q_2 repeats the measured positions: it is not a command; without all"
    )


@pytest.mark.parametrize("rows", [0, 1])
def test_commands_of_a_joint_at_rest_or_of_coarse_steps_are_commands(tmp_path, arm, signals, rows):
    """Steps of 0.01 rad, a row late: most rows are equal, but not those of the steps."""
    q, commands = signals["q"].copy(), signals["command"].copy()
    if rows:
        commands = 0.01 * np.round(q / 0.01)
        q = np.vstack([commands[:rows], commands[:-rows]])
    else:
        q[:, 3] = commands[:, 3] = -1.5
    assert (
        examine_log(
            made.write(tmp_path, made.frame({**signals, "q": q, "command": commands}, made.RTDE)), arm
        ).questions
        == []
    )
    assert examine_log(tmp_path / "log.csv", arm).motion.commanded


def numbered(signals, count):
    """Return a log of numbered joints: those of the signals, and further ones that repeat them."""
    places = [place % 6 for place in range(count)]
    return made.frame(
        {**signals, **{kind: signals[kind][:, places] for kind in ("q", "tau")}}, {**made.PLAIN, "q": "pos{}"}
    )


@pytest.mark.parametrize(
    ("robot", "count", "wanted"),
    [
        ("panda", 6, "positions of 6 joints (pos0 to pos5), and panda has 7. Allowed: another robot, or"),
        ("panda", 2, "positions of 2 joints (pos0 and pos1), and panda has 7. Allowed: another robot, or"),
        ("macro", 6, "positions of 6 joints (pos0 to pos5), and macro has 3: two arms? Allowed: a log of one"),
        (
            "ur5e",
            12,
            "positions of 12 joints (pos0 to pos11), and ur5e has 6: two arms? Allowed: a log of one",
        ),
    ],
)
def test_a_log_of_another_robot_is_refused_with_both_numbers(cli, tmp_path, signals, robot, count, wanted):
    ending = cli("compare", made.write(tmp_path, numbered(signals, count)), "--robot", robot)
    assert ending.code == 2
    assert f"log.csv: {wanted}" in ending.err


@pytest.mark.parametrize("count", [6, 7, 8, 11])
def test_further_numbered_joints_are_named(tmp_path, arm, signals, count):
    found = examine_log(made.write(tmp_path, numbered(signals, count)), arm)
    said = f"positions of {count} joints (pos0 to pos{count - 1}), and ur5e has 6: pos0 to pos5 are taken"
    assert [finding.text for finding in found.findings if finding.place == "positions"] == [said] * (count > 6)
    assert (said in found.motion.notes) == (said in found.recording.notes) == (count > 6)
