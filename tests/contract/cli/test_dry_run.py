"""Previews of runs and sweeps: their cells, what is stored, and nothing that is stored by them."""

import json

import pytest

LINE = ("plant=rk4", "duration=0.05", "noise.position=1e-4,1e-3", "seed=range(0,3)")


def test_a_preview_shows_axes_and_ends_and_stores_nothing(cli, tmp_path):
    ending = cli("-m", *LINE, "--dry-run")
    assert (ending.code, ending.err) == (0, "")
    lines = ending.out.splitlines()
    assert lines[:2] == ["noise.position  2 values: 0.0001, 0.001", "seed            3 values: 0, 1, 2"]
    assert lines[2] == "all cells: plant=rk4 duration=0.05"
    assert lines[3].startswith("6 cells, 0 stored already, 6 to simulate, ")
    assert lines[4:6] == ["first: noise.position=0.0001 seed=0", "last:  noise.position=0.001 seed=2"]
    assert lines[6] == "dry run: nothing is simulated or stored"
    assert list(tmp_path.iterdir()) == []


def test_a_preview_knows_what_is_stored(cli):
    cli(*LINE[:2], "noise.position=1e-3", "seed=1")
    found = json.loads(cli("sweep", *LINE, "--dry-run", "--json").out)
    assert [cell["overrides"][2:] for cell in found["cells"] if cell["stored"]] == [["noise.position=0.001", "seed=1"]]
    assert len({cell["run"] for cell in found["cells"]}) == 6
    assert found["axes"][1] == {"key": "seed", "values": [0, 1, 2]}
    assert found["cpu_time"]["seconds"] > 0
    assert (
        "1 cell, 1 stored already, none to simulate" in cli(*LINE[:2], "noise.position=1e-3", "seed=1", "--dry-run").out
    )


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (("seed=0,1", "--dry-run"), "'seed=0,1' gives several values; `runner -m` sweeps over them"),
        (("-m", "seed=0,-1", "--dry-run"), "[seed=-1] seed: must be 0 or more"),
        (("-m", "seed=0,1", "--json"), "--json: prints the cells of a preview. Add --dry-run."),
    ],
)
def test_a_wrong_line_is_refused(cli, tmp_path, line, message):
    ending = cli(*line)
    assert (ending.code, ending.out) == (2, "")
    assert message in ending.err
    assert list(tmp_path.iterdir()) == []
