"""Meanings of columns by their names, as programs of laboratories write them."""

from pathlib import Path

import numpy as np
import pytest

from runner.base.tables import NumericTable
from runner.doctor.log_names import named

T = np.linspace(0.0, 1.0, 20)


def meanings(names, others=None):
    columns = dict.fromkeys(names, T) | {"counter": np.cos(20.0 * T)}
    return {one.column: one for one in named(NumericTable(Path("log"), "text", columns, others=others or {}))}


@pytest.mark.parametrize(
    ("column", "kind", "label"),
    [
        ("state.q.0", "position", "0"),
        ("robot_state/joint_positions.3", "position", "3"),
        ("obs/joint_pos_2", "position", "2"),
        ("jointPosition4", "position", "4"),
        ("Joint 1 Position (deg)", "position", "1"),
        ("Achse1.Istposition [deg]", "position", "achse1"),
        ("action/joint_pos_2", "reference", "2"),
        ("desired.q.1", "reference", "1"),
        ("target_joint_positions.1", "reference", "1"),
        ("Soll_A3", "reference", "a3"),
        ("state.dq.5", "velocity", "5"),
        ("joint_velocities.0", "velocity", "0"),
        ("jointTorque2", "torque", "2"),
        ("axis1.actual_torque[mNm]", "torque", "1"),
    ],
)
def test_a_name_has_a_meaning(column, kind, label):
    found = meanings([column])[column]
    assert (found.kind, found.label) == (kind, label)


@pytest.mark.parametrize("column", ["cmd_torque_1", "target_velocity_2", "contact.force.0", "state.mode.1"])
def test_another_name_has_none(column):
    assert column not in meanings([column])


@pytest.mark.parametrize(("time", "unit"), [("sim_time", ""), ("Zeitstempel_ms", "ms"), ("controller time [s]", "s")])
def test_a_name_with_a_word_of_time_is_the_time_if_no_other_is(time, unit):
    (found,) = (one for one in meanings([time, "q1"]).values() if one.kind == "time")
    assert (found.column, found.unit) == (time, unit)
    assert "step_time" not in meanings(["t", "step_time", "q1"])
    assert meanings(["elbow.position", "t"])["t"].kind == "time"  # also with names of ROS


def test_names_next_to_a_list_are_those_of_its_joints():
    found = meanings(["msg.position.0", "msg.position.1"], {"msg.name.0": "elbow", "msg.name.1": ""})
    assert [one.label for one in found.values()] == ["elbow", "1"]
