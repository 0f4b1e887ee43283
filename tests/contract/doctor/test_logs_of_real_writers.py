"""`runner doctor LOG` on files that the programs themselves wrote, up to the map that `runner compare` takes."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.recordings.columns_map import read_map
from runner.recordings.consistency import check_consistency
from runner.recordings.recording import read_recording

FOLDER = Path(__file__).parents[2] / "recorded" / "logs"
FORMS = {
    "libfranka.csv": ("panda", "libfranka or panda-python"),
    "mcap_controller_state.mcap": ("ur5e", "MCAP"),
    "mcap_ros2.mcap": ("ur5e", "MCAP"),
    "mecademicpy.zip": ("meca500", "mecademicpy"),
    "record_py.csv": ("ur5e", "UR's RTDE client"),
    "rosbags.bag": ("ur5e", "ROS 1 bag"),
    "rosbags_db3": ("ur5e", "compressed bag"),
    "rosbags_mcap": ("ur5e", "MCAP"),
    "ur_rtde.csv": ("ur5e", "ur-rtde's recorder"),
}
RATES = np.array([1.3, 1.9, 1.6, 2.2, 1.1, 2.6, 1.7])  # rad/s, of the motion that all hold
LATE = 0.008  # s, of the arm behind its commands


def test_each_recorded_file_is_tried():
    assert {path.name for path in FOLDER.iterdir()} == {*FORMS, "README.md"}


@pytest.mark.costs(2)
@pytest.mark.parametrize("name", FORMS)
def test_no_step_by_hand_is_needed(cli, tmp_path, name):
    if name.endswith((".mcap", ".bag")) or "." not in name:
        pytest.importorskip("rosbags", reason="reads bags")
    robot, form = FORMS[name]
    ending = cli("doctor", FOLDER / name, "--robot", robot, "-o", tmp_path / "mine")
    assert ending.code == 0, ending.out + ending.err
    assert form in ending.out.splitlines()[0]
    assert (tmp_path / "mine" / "motion.csv").is_file()
    model = validate(compose([f"robot={robot}"])).arm.model
    said, factors = read_map(tmp_path / "mine" / "columns.yaml", model.joint_names, model.joint_units)
    recording = read_recording(FOLDER / name, said, factors, 0.1)
    assert check_consistency(said.loaded(model), recording).questions == ()
    q = recording.positions(model.joint_names)

    def differs(start):
        t = np.maximum(recording.t[:, None] + start - LATE, 0.0)
        return np.abs(q - q[0] - 0.3 * (np.cos(RATES[: model.nq] * t[:1]) - np.cos(RATES[: model.nq] * t))).max()

    assert min(map(differs, np.arange(0.0, 0.3, 0.002))) < 0.01  # rows of ur-rtde are of two moments


def test_the_base_of_a_controller_is_proposed_and_asked_for_in_your_own_map(cli, tmp_path):
    log, mine = FOLDER / "record_py.csv", tmp_path / "mine" / "columns.yaml"
    assert "sign: -1 is proposed for x and y" in cli("doctor", log, "--robot", "ur5e", "-o", mine.parent).out
    assert mine.read_text().count("sign: -1") == 2
    mine.write_text(mine.read_text().replace(", sign: -1", ""))
    ending = cli("doctor", log, "--robot", "ur5e", "--columns", mine)
    assert ending.code == 1
    assert "as in a base that is turned by half a turn about z; 103% of the tip is unexplained now, 0%" in ending.out
    assert "Say sign: -1 for both." in ending.out


def test_rows_of_two_moments_do_not_spoil_the_unit_of_a_torque(cli, tmp_path):
    """ur-rtde writes such rows: a time with the values of the next one. They spoil accelerations."""
    table = pd.read_csv(FOLDER / "record_py.csv", sep=" ")
    for row in (60, 61, 62, 80):
        table.iloc[row, 1:] = table.iloc[row + 1, 1:]
    table.to_csv(tmp_path / "log.csv", index=False)
    ending = cli("doctor", tmp_path / "log.csv", "--robot", "ur5e")
    assert (ending.code, ending.out.count("ask  ")) == (0, 0), ending.out
