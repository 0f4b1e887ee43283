"""Stored runs: what is written, how it is read back, and what damage or a full disk leads to."""

import errno
import json
import os
import pathlib
import re
import shutil

import numpy as np
import pytest
import yaml
from fixtures.stored import RUNS, SHORT

import runner
from runner.base.atomic import write_atomically
from runner.base.errors import StoreError
from runner.store import DamagedError, Run, find_run, open_run, prepare, seal
from runner.store.seal import sealed_json


@pytest.fixture
def run(copy_run):
    return open_run(copy_run("noise"))


def refuse(code):
    """Return a function that raises an operating system's error for any arguments."""

    def call(*_, **__):
        raise OSError(code, os.strerror(code))

    return call


def test_the_record_follows_its_schema(run):
    record = json.loads((run.folder / "metrics.json").read_text())
    of_result = ["status", "repetitions", "caveats", "caveat_rules", "metrics", "timing", "provenance"]
    assert list(record) == ["schema", "digest", "name", "files", *of_result]
    assert (record["schema"], record["status"], record["repetitions"]) == (3, "ok", 2)
    for metric in record["metrics"].values():
        assert set(metric) == {"unit", "values", "median", "min", "max"}
        assert len(metric["values"]) == 2
    assert {"tick_time_median", "tick_time_p99", "wall_s", "cpu_s"} <= set(record["timing"])
    assert {"commit", "versions", "machine", "seed", "command", "plant_step", "choices"} <= set(record["provenance"])


def test_the_trace_carries_units(run):
    assert list(run.trace().columns[:4]) == ["t", "q1", "q2", "q3"]
    assert {run.units[name] for name in ("t", "q1", "dq1", "tau1", "tip_x", "error_z")} == {
        "s",
        "rad",
        "rad/s",
        "N m",
        "m",
    }
    np.testing.assert_allclose(run.trace()["t"], np.arange(6) * 0.01, rtol=1e-12)
    np.testing.assert_array_equal(run.trace()["error_x"], run.trace()["desired_x"] - run.trace()["tip_x"])


def test_a_copied_run_is_read_elsewhere(run, tmp_path):
    copy = open_run(shutil.copytree(run.folder, tmp_path / "else" / "where"))
    shutil.rmtree(tmp_path / "outputs")
    assert copy.metrics == run.metrics
    assert copy.config["robot"]["name"] == "macro"
    assert copy.urdf.startswith("<robot")
    assert len(copy.trace()) == 6


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("metrics.json", None, "is a run that did not finish: it has no metrics.json"),
        ("metrics.json", b"", "metrics.json: it is damaged: Expecting value"),
        ("metrics.json", b'{"schema": 3, "sta', "metrics.json: it is damaged: Unterminated string"),
        ("metrics.json", b"\xff\xfe\x00\x01", "metrics.json: it is damaged: "),
        ("metrics.json", b"[" * 100_000, "metrics.json: it is damaged: nested deeper than 100 levels"),
        ("metrics.json", b"1" * 6000, "metrics.json: it is damaged: Exceeds the limit"),
        ("metrics.json", b"[]", "metrics.json: it is damaged: it names no schema"),
        ("metrics.json", b"{}", "metrics.json: it is damaged: it names no schema"),
        ("metrics.json", b'{"schema": 2, "digest": ""}', "its content has another digest than it says"),
        ("metrics.json", b'{"schema": 3}', "metrics.json: it is damaged: its content has another digest than it says"),
        ("config.yaml", None, "config.yaml: No such file or directory; run it again to repair it"),
        ("config.yaml", b"a: [\n", "config.yaml: it is damaged: its content has another digest than stored"),
        ("config.yaml", b"3", "config.yaml: it is damaged: its content has another digest than stored"),
    ],
)
def test_a_damaged_run_is_said_by_every_command_and_made_again(cli, run, name, content, message):
    path = run.folder / name
    good = path.read_bytes()
    path.unlink() if content is None else path.write_bytes(content)
    for command in (("check", run.folder), ("compare", run.folder, run.folder), ("report", run.folder)):
        ending = cli(*command)
        assert (ending.code, ending.out) == (2, "")
        assert message in ending.err
        assert "Traceback" not in ending.err
    again = cli(*RUNS["noise"])
    assert again.folder == run.folder
    assert ("making it again" in again.err) == (name != "metrics.json" or content is not None)
    if name == "config.yaml":  # the run that was copied here had other outputs
        assert yaml.safe_load(path.read_bytes()) == yaml.safe_load(good) | {"outputs": "./outputs"}
    assert open_run(run.folder).metrics == run.metrics


@pytest.mark.parametrize("schema", [1, 2, 4])
def test_a_run_of_another_schema_is_refused_by_name(cli, run, monkeypatch, schema):
    record = {key: value for key, value in run.record.items() if key != "schema"}
    with monkeypatch.context() as patch:
        patch.setattr(seal, "SCHEMA", schema)
        (run.folder / "metrics.json").write_bytes(seal.sealed_json(record))
    for command in (("check", run.folder), ("compare", run.folder, run.folder), ("report", run.folder)):
        ending = cli(*command)
        assert (ending.code, ending.out) == (2, "")
        assert re.fullmatch(
            rf"runner: cannot read \S+/metrics\.json: it has schema {schema}, and this version reads schema 3; "
            r"make it again in another folder, as in outputs=FOLDER\n",
            ending.err,
        )


@pytest.mark.parametrize("content", [None, b"", b"\xff\xfe", b"cut"], ids=["missing", "empty", "binary", "truncated"])
def test_a_damaged_trace_is_said_and_made_again(cli, run, content):
    path = run.folder / "trace.parquet"
    good = path.read_bytes()
    path.unlink() if content is None else path.write_bytes(good[:1000] if content == b"cut" else content)
    with pytest.raises(StoreError, match=r"cannot read .*trace\.parquet: .*; run it again to repair it"):
        _ = open_run(run.folder).trace()
    ending = cli("report", run.folder)
    assert ending.code == 2
    assert "run it again to repair it" in ending.err
    with pytest.raises(DamagedError, match=r"trace\.parquet"):
        find_run(run.folder.parent.parent, run.hash)
    assert cli(*RUNS["noise"]).folder == run.folder
    assert path.read_bytes() == good


@pytest.mark.parametrize("content", [None, b"\xff\xfe"])
def test_a_damaged_urdf_is_said(run, content):
    path = run.folder / "robot.urdf"
    path.unlink() if content is None else path.write_bytes(content)
    with pytest.raises(StoreError, match=r"cannot read .*robot\.urdf: "):
        _ = open_run(run.folder).urdf


def test_a_run_under_the_name_of_another_is_told_and_made_again(cli, run, copy_run, tmp_path):
    other = copy_run("goal")
    shutil.rmtree(run.folder)
    shutil.copytree(other, run.folder)
    ending = cli("report", run.folder)
    assert (ending.code, ending.out) == (2, "")
    assert f"metrics.json: it is the record of another job, {other.name}; run it again to repair it" in ending.err
    assert cli("verify").code == 1
    assert cli(*RUNS["noise"]).folder == run.folder
    assert open_run(run.folder).metrics == run.metrics
    assert open_run(shutil.copytree(other, tmp_path / "mine")).hash == "mine"  # a copy elsewhere may have any name


@pytest.mark.parametrize(
    ("key", "value", "found"),
    [
        (("status",), "fine", "status: Input should be 'ok' or 'failed'"),
        (("metrics", "peak_torque", "median"), ["x"], "metrics.peak_torque.median: Input should be a valid number"),
        (("metrics", "peak_torque", "values"), [{}], "metrics.peak_torque.values.0: Input should be a valid number"),
        (("caveats",), [{"rule": "<b>"}], "caveats.0.text: Field required"),
        (("spec",), {"bounds": [], "all": 3}, "spec.bounds: Input should be a valid dictionary"),
        (("provenance", "command"), None, "provenance.command: Input should be a valid string"),
    ],
)
def test_a_record_that_somebody_made_up_is_told_though_its_digests_are_right(cli, run, key, value, found):
    record = json.loads((run.folder / "metrics.json").read_text())
    *groups, last = key
    place = record
    for group in groups:
        place = place[group]
    place[last] = value
    made_up = {name: each for name, each in record.items() if name not in ("schema", "digest")}
    (run.folder / "metrics.json").write_bytes(sealed_json(made_up))
    ending = cli("report", run.folder)
    assert (ending.code, ending.out) == (2, "")
    assert f"metrics.json: it is not a run's record: {found}" in ending.err
    assert ending.err.endswith("; run it again to repair it\n")


def test_who_changes_a_trace_changes_a_copy(run):
    before = run.trace().copy()
    changed = run.trace()
    changed["q1"] = 0.0
    changed.loc[:, "q2"] += 1.0
    assert run.trace().equals(before)
    assert not changed.equals(before)


def test_a_failed_run_says_why_in_words(run):
    failure = {"repetition": 1, "time": 0.12345, "joint": None, "reason": "singular"}
    failed = Run(run.folder, run.config, {**run.record, "status": "failed", "failure": failure})
    assert run.failure is None
    assert failed.failure == "failed in repetition 1 at t = 0.1235 s: singular"


@pytest.mark.parametrize("place", ["a_file", "/proc/nowhere", "a_file/below"])
def test_an_outputs_folder_that_cannot_be_written_to_is_said_before_simulating(cli, tmp_path, monkeypatch, place):
    (tmp_path / "a_file").write_text("kept")
    monkeypatch.setattr(runner.sweeps.job, "simulate_run", None)
    for command in (SHORT, ("-m", "hydra.sweeper.workers=0", *SHORT, "seed=0,1")):
        ending = cli(*command, f"outputs={place}")
        assert (ending.code, ending.out) == (2, "")
        assert ending.err.startswith(f"runner: cannot write {place}/runs/.writable: ")
        assert ending.err.endswith("; choose a folder that can be written to, as in outputs=FOLDER\n")
        assert ending.err.count("\n") == 1
    assert (tmp_path / "a_file").read_text() == "kept"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a_file"]


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EACCES, errno.EROFS, errno.EIO])
@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_disk_that_gives_up_leaves_no_half_written_file(cli, tmp_path, monkeypatch, code, call):
    prepare(tmp_path / "outputs")
    monkeypatch.setattr("runner.store.prepare", lambda _: None)  # it fills up while the run is simulated
    monkeypatch.setattr(*{"fsync": (os, "fsync"), "replace": (pathlib.Path, "replace")}[call], refuse(code))
    ending = cli(*SHORT)
    assert (ending.code, ending.out) == (2, "")
    assert ending.err.startswith("runner: cannot write outputs/runs/")
    mend = "; free space on its disk" if code == errno.ENOSPC else ""
    assert ending.err.endswith(f": {os.strerror(code)}{mend}\n")
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_the_metrics_come_last(cli, tmp_path, monkeypatch):
    written = []

    def write(path, content, **how):
        written.append(path.name)
        write_atomically(path, content, **how)

    monkeypatch.setattr("runner.store.seal.write_atomically", write)
    cli(*SHORT)
    assert written == ["trace.parquet", "config.yaml", "robot.urdf", "metrics.json"]


def test_writing_over_a_file_keeps_the_old_one_until_the_new_one_is_whole(tmp_path, monkeypatch):
    path = tmp_path / "deep" / "file"
    write_atomically(path, b"old")
    monkeypatch.setattr(os, "fsync", refuse(errno.ENOSPC))
    with pytest.raises(StoreError, match="No space left on device"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(path.parent.iterdir()) == [path]
