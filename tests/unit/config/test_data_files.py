"""Data file of a trajectory: its content in the config, where it is looked for, and what is refused."""

import pytest

from runner.base.errors import ConfigError
from runner.config.compose.compose import take_data_file

ROWS = "t,x,y,z\n0,0.1,0.2,0.3\n0.5,0.1,0.2,0.4\n1.5,0.1,0.2,0.5\n"


def _config(name="path.csv", duration=None):
    return {"trajectory": {"kind": "from_file", "file": name, "duration": duration}}


@pytest.mark.parametrize("group", [{}, {"kind": "goal", "file": "a.csv"}, {"kind": "from_file", "file": None}, None])
def test_other_trajectories_have_none(group):
    resolved = {"trajectory": group}
    take_data_file(resolved, [])
    assert resolved == {"trajectory": group}


@pytest.mark.parametrize(("duration", "wanted"), [(None, 1.5), (1.0, 1.0)])
def test_the_content_is_taken_and_its_end_is_the_duration_unless_one_is_given(tmp_path, duration, wanted):
    (tmp_path / "path.csv").write_text(ROWS)
    resolved = _config(duration=duration)
    take_data_file(resolved, [tmp_path])
    assert resolved["trajectory"]["columns"]["t"] == [0.0, 0.5, 1.5]
    assert resolved["trajectory"]["columns"]["z"] == [0.3, 0.4, 0.5]
    assert resolved["trajectory"]["duration"] == wanted


@pytest.mark.parametrize(
    ("name", "problem"),
    [("../path.csv", "leads out of its folder"), ("other.csv", "no file 'other.csv'; looked in ")],
)
def test_files_elsewhere_are_refused(tmp_path, name, problem):
    with pytest.raises(ConfigError, match=f"trajectory.file: .*{problem}"):
        take_data_file(_config(name), [tmp_path])
