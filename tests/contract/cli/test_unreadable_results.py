"""Results that are damaged, older or forged: each is a row, and none stops a list, a check or a removal."""

import json
import os
import shutil

import pytest
import yaml

from runner.base.dotted_keys import put
from runner.store.seal import digest, sealed_json


def age(path):
    """Let a file seem to be of an earlier version of the runner, whose records had no digest."""
    content = json.loads(path.read_bytes())
    del content["digest"]
    path.write_text(json.dumps({**content, "schema": 2}))


def forge(run, place, value):
    """Put a value into the config of a copied run, and make all its digests right."""
    config = yaml.safe_load((run / "config.yaml").read_text())
    put(config, place, value)
    text = yaml.dump(config, sort_keys=False)
    (run / "config.yaml").write_text(text)
    record = json.loads((run / "metrics.json").read_bytes())
    files = record["files"] | {"config.yaml": digest(text.encode())}
    kept = {key: value for key, value in record.items() if key not in ("schema", "digest")}
    (run / "metrics.json").write_bytes(sealed_json({**kept, "files": files}))


def row(ending, name):
    (line,) = (line for line in ending.out.splitlines() if line.endswith(name))
    return line


def test_a_run_and_a_sweep_of_another_version_are_rows(cli, copy_run, copy_sweep, tmp_path):
    sweep, alone = copy_sweep("goal", "other seed"), copy_run("noise")
    age(sweep / "sweep.json")
    age(alone / "metrics.json")
    ending = cli("results", "outputs")
    assert (ending.code, ending.err) == (0, "")
    assert len(ending.out.splitlines()) == 5  # the runs of the sweep are no longer known as its own
    for folder in (sweep, alone):
        assert "  other version  " in row(ending, folder.name)
        assert "schema 2, and this version..." in row(ending, folder.name)
    assert cli("results", "outputs", "-o", "page.html").code == 0
    assert "other version" in (tmp_path / "page.html").read_text()
    checked = cli("verify", "outputs")
    assert (checked.code, checked.err) == (1, "")
    assert "runs: 2 as written, 1 of another version" in checked.out
    assert "sweeps: 1 of another version" in checked.out


def test_an_older_sweep_that_stays_keeps_its_runs_and_stops_no_removal(cli, copy_run, copy_sweep):
    sweep = copy_sweep("goal", "other seed")
    report = cli("report", copy_run("noise"), "--format", "html").folder
    age(sweep / "sweep.json")
    for folder in (*(sweep.parents[1] / "runs").iterdir(), report):
        for path in folder.iterdir():
            os.utime(path, (0.0, 0.0))
    ending = cli("results", "outputs", "--delete", "1d", "--yes")
    assert ending.code == 0
    assert ending.out.split() == [f"outputs/reports/{report.name}"]
    assert "schema 2" in ending.err
    assert "Its runs are not known, and no run is removed" in ending.err
    assert len(list((sweep.parents[1] / "runs").iterdir())) == 3
    assert not report.exists()


@pytest.mark.parametrize(
    ("place", "value", "expected"),
    [
        (("robot", "home"), [0, "x", 0], "robot.home.1: "),
        (("robot", "home"), -1, "robot.home: "),
        (("robot", "tip"), None, "robot.tip: "),
        (("robot",), -1, "robot: "),
        (("trajectory",), "x", "trajectory: "),
        (("seed",), "x", "seed: "),
    ],
)
def test_a_config_that_fits_no_run_is_a_row_and_one_sentence(cli, copy_sweep, place, value, expected):
    sweep = copy_sweep("goal", "other seed")
    runs = sorted((sweep.parents[1] / "runs").iterdir())
    forge(runs[0], place, value)
    shutil.copytree(runs[0], sweep.parents[1] / "runs" / "alone")
    listed = cli("results", "outputs")
    assert (listed.code, listed.err) == (0, "")
    assert "  damaged  " in row(listed, sweep.name)
    for words in (("table", runs[0]), ("compare", *runs)):
        ending = cli(*words)
        assert (ending.code, ending.out) == (2, "")
        assert f"config.yaml: it is not a run's config: {expected}" in ending.err
        assert len(ending.err.splitlines()) == 1


def test_a_home_of_another_length_is_one_sentence(cli, copy_sweep):
    runs = sorted((copy_sweep("goal", "other seed").parents[1] / "runs").iterdir())
    forge(runs[0], ("robot", "home"), [0.0, 0.5])
    ending = cli("compare", *runs)
    assert (ending.code, len(ending.err.splitlines())) == (2, 1)
    assert "robot.home of a stored run: [0.0, 0.5] does not fit its robot" in ending.err


def test_a_tuning_whose_fresh_runs_are_no_runs_is_a_row(cli, tuned):
    made = tuned(trials=2)
    path = made.folder / "tuning.json"
    content = json.loads(path.read_bytes())
    kept = {key: value for key, value in content.items() if key not in ("schema", "digest")}
    path.write_bytes(sealed_json({**kept, "fresh": "x"}))
    listed = cli("results", "outputs")
    assert listed.code == 0
    assert "  damaged  " in row(listed, made.folder.name)
    ending = cli("results", "outputs", "--delete", "9999d")
    assert ending.code == 0
    assert "fresh does not name two runs; the tuning's command makes it again. Its runs are not known" in ending.err
    assert cli("report", path.parent).code == 2
