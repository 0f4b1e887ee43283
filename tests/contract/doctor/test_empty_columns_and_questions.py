"""`runner doctor LOG`: columns without numbers are named, and a question is asked once, for all its columns."""

import numpy as np
import pandas as pd
import pytest
from support import log_files as made

from runner.assembly.validation import validate
from runner.base.errors import RunnerError
from runner.config.compose.compose import compose
from runner.doctor.log import examine_log

RTDE = made.RTDE
JOINT_STATES = {"t": "t", "q": "{}.feedback.position", "command": "{}.reference.position", "tau": "{}.feedback.effort"}


def by_joint(signals, arm):
    """Return a table whose columns have the names of the joints."""
    table = made.frame(signals, JOINT_STATES)
    return table.rename(columns=lambda name: f"{arm.joint_names[int(name[0])]}{name[1:]}" if "." in name else name)


def recorded(found, kind):
    return sorted(signal.of for signal in found.recording.of_kind(kind))


def texts(found):
    return [str(finding) for finding in found.findings]


@pytest.mark.parametrize("place", range(6))
def test_a_torque_without_numbers_leaves_those_of_the_other_joints(tmp_path, arm, signals, place):
    column, joint = RTDE["tau"].format(place), arm.joint_names[place]
    found = examine_log(made.write(tmp_path, made.frame(signals, RTDE).assign(**{column: np.nan})), arm)
    assert recorded(found, "torque") == sorted(set(arm.joint_names) - {joint})
    assert f"note    torques: {column} has no numbers: no torque of {joint}" in texts(found)
    assert found.recording.notes[-1] == f"{column} has no numbers: no torque of {joint}"
    assert found.motion.commanded
    assert column not in [one.column for one in found.meanings]


@pytest.mark.parametrize("place", range(6))
def test_a_command_without_numbers_is_named_and_no_command_used(tmp_path, arm, signals, place):
    column = RTDE["command"].format(place)
    found = examine_log(made.write(tmp_path, made.frame(signals, RTDE).assign(**{column: np.nan})), arm)
    said = f"{column} has no numbers; without all commands the motion follows the measured positions"
    assert f"note    commands: {said}" in texts(found)
    assert said in found.motion.notes
    assert not found.motion.commanded
    assert recorded(found, "reference") == []
    assert len(recorded(found, "torque")) == 6


@pytest.mark.parametrize("place", range(6))
def test_a_position_without_numbers_is_refused_by_its_name(cli, tmp_path, arm, signals, place):
    column, joint = RTDE["q"].format(place), arm.joint_names[place]
    path = made.write(tmp_path, made.frame(signals, RTDE).assign(**{column: np.nan}))
    ending = cli("doctor", path, "--robot", "ur5e")
    assert ending.code == 2
    assert f"log.csv: {column} has no numbers: no position of {joint}. Allowed: a log with the positions of all" in (
        ending.err
    )


@pytest.mark.parametrize("kind", ["q", "command", "tau"])
def test_columns_with_names_of_joints_may_be_empty_too(tmp_path, arm, signals, kind):
    column = JOINT_STATES[kind].replace("{}", "elbow_joint")
    path = made.write(tmp_path, by_joint(signals, arm).assign(**{column: np.nan}))
    if kind == "q":
        with pytest.raises(RunnerError, match=r"elbow_joint\.feedback\.position has no numbers"):
            examine_log(path, arm)
        return
    found = examine_log(path, arm)
    assert f"{column} has no numbers" in " ".join(texts(found))
    assert len(recorded(found, "torque")) == (5 if kind == "tau" else 6)


def test_a_signal_without_any_number_is_none(tmp_path, arm, signals):
    table = made.frame(signals, RTDE)
    for kind in ("tau", "dq", "q"):
        table = table.assign(**dict.fromkeys(map(RTDE[kind].format, range(6)), np.nan))
        found = examine_log(made.write(tmp_path, table), arm)
        assert recorded(found, "torque") == []
        known = signals["command" if kind == "q" else "q"]
        assert found.recording.positions(arm.joint_names) == pytest.approx(known)
    assert "actual_current_as_torque_5 have no numbers: no torque of" in " ".join(texts(found))
    commands = made.frame(signals, RTDE).assign(**dict.fromkeys(map(RTDE["command"].format, range(6)), np.nan))
    assert not examine_log(made.write(tmp_path, commands), arm).motion.commanded


def test_an_empty_second_arm_is_none(tmp_path, arm, signals):
    table = by_joint(signals, arm)
    second = {f"right_{name}": np.nan for name in table.columns if name != "t"}
    found = examine_log(made.write(tmp_path, table.assign(**second)), arm)
    assert found.recording.positions(arm.joint_names) == pytest.approx(signals["q"])


def test_a_seventh_column_does_not_move_the_others(tmp_path, arm, signals):
    """An empty column in the midst of more columns than joints keeps its number: here joint 3 of 6."""
    table = made.frame(signals, made.PLAIN, 1).assign(q7=0.0, tau7=0.0, tau3=np.nan)
    found = examine_log(made.write(tmp_path, table), arm)
    assert recorded(found, "torque") == sorted(set(arm.joint_names) - {"elbow_joint"})


def panda_python(tmp_path, signals):
    lists = {"q": signals["q"], "q_d": signals["q"], "dq": signals["dq"], "tau_J": signals["tau"]}
    rows = np.arange(500)
    np.savez(tmp_path / "log.npz", time=rows, **{name: values[rows] for name, values in lists.items()})
    return tmp_path / "log.npz"


def test_an_open_time_is_the_only_question(cli, tmp_path, arm, signals):
    path = panda_python(tmp_path, signals)
    assert [question.place for question in examine_log(path, arm).questions] == ["time"]
    ending = cli("compare", path, "--robot", "ur5e")
    assert ending.code == 2
    assert "log.npz: time: it counts rows by 1: is it ms, or a number of rows? say unit: ms, or rate: in Hz. " in (
        ending.err
    )
    assert ending.err.count(";") == 0


def test_a_unit_of_all_columns_is_asked_for_once(tmp_path):
    motors = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll")
    states = 90.0 * np.sin(np.outer(np.arange(120) / 30.0, [1.0, 1.3, 1.7, 1.1, 2.0]))
    folder = made.write_lerobot(tmp_path / "set", states, motors)
    model = validate(compose(["robot=so101"])).arm.model
    (question,) = examine_log(folder, model).questions
    names = [f"observation.state.{motor}.pos" for motor in motors]
    assert question.place == f"{names[0]} (also {', '.join(names[1:4])} and 6 more)"
    assert question.text.startswith("-66.11 to 90 is per cent of the calibrated range or degrees: say unit: deg")


def test_a_sign_of_all_torques_is_asked_for_once_with_all_columns(cli, tmp_path, arm, signals):
    path = made.write(tmp_path, made.frame({**signals, "tau": -signals["tau"]}, RTDE))
    (question,) = examine_log(path, arm).questions
    assert all(RTDE["tau"].format(place) in question.place for place in range(6))
    assert question.text.count("opposite sign") == 1
    assert cli("compare", path, "--robot", "ur5e").err.count("Say sign: -1") == 1


def test_other_questions_stay_apart(tmp_path, arm, signals):
    q = signals["q"] * np.array([1, 1, -1, 1, 1, 1])
    tau = signals["tau"].copy()
    tau[:, 0] = 0.0
    table = made.frame({**signals, "q": q, "tau": tau}, made.PLAIN, 1)
    assert [question.place for question in examine_log(made.write(tmp_path, table), arm).questions] == [
        "tau1",
        "columns.q3",
    ]
    per_cent = pd.DataFrame(table).rename(columns={f"tau{n}": f"tau{n} [%]" for n in range(1, 7)})
    asked = examine_log(made.write(tmp_path, per_cent.assign(**{"tau1 [%]": 1.0})), arm).questions
    assert [question.text[:24] for question in asked if "tau" in question.place] == ["per cent of a maximum, u"]
