"""Stored sweeps: opened as they were made; damaged and foreign folders are named."""

import json

import pytest
from fixtures.stored import RUNS

from runner.base.errors import StoreError
from runner.store import Run, Sweep, open_runs, open_stored, open_sweep, write_sweep
from runner.store.seal import sealed_json, write_job
from runner.store.shards import write_shard


@pytest.fixture
def sweep(copy_sweep):
    return copy_sweep("goal", "other seed")


def test_a_sweep_opens_with_its_runs_in_order(sweep):
    opened = open_sweep(sweep)
    assert opened.overrides == [RUNS["goal"], RUNS["other seed"]]
    assert [run.config["seed"] for run in opened.runs()] == [0, 1]
    assert [run.hash for run in opened.runs()] == list(opened.hashes)
    assert [run.hash for run in open_runs(sweep)] == list(opened.hashes)


def test_a_run_opens_as_a_list_of_one(sweep):
    run = next(open_sweep(sweep).runs())
    assert [opened.hash for opened in open_runs(run.folder)] == [run.hash]


def test_folders_tell_what_they_are(sweep, tmp_path):
    run = next(open_sweep(sweep).runs()).folder
    assert [type(open_stored(folder)) for folder in (sweep, run)] == [Sweep, Run]
    with pytest.raises(StoreError, match="is not a stored run: it has no metrics"):
        open_stored(tmp_path)


def test_the_same_jobs_are_the_same_sweep(tmp_path):
    jobs = [(("seed=0",), "a"), (("seed=1",), "b")]
    folder = write_sweep(tmp_path, jobs, "runner -m seed=0,1")
    assert write_sweep(tmp_path, jobs, "runner -m seed=0,1 hydra.sweeper.workers=0") == folder
    assert write_sweep(tmp_path, jobs[::-1], "") != folder
    assert open_sweep(folder).command == "runner -m seed=0,1 hydra.sweeper.workers=0"
    assert json.loads((folder / "sweep.json").read_text())["schema"] == 3


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "sweep.json: it is damaged: Expecting value"),
        (b'{"jobs": [{"overr', "sweep.json: it is damaged: Unterminated"),
        (b"\xff\xfe", "sweep.json: it is damaged: "),
        (b"{}", "sweep.json: it is damaged: it names no schema"),
        (b"[]", "sweep.json: it is damaged: it names no schema"),
        (b'{"schema": 2, "jobs": []}', "it has schema 2, and this version reads schema 3; make it again in another"),
        (b'{"schema": 3, "jobs": []}', "its content has another digest than it says"),
        (sealed_json({}), "it is not a sweep's: it needs jobs with overrides and run each"),
        (sealed_json({"jobs": [{"overrides": []}]}), "it is not a sweep's"),
        (sealed_json({"jobs": [{"overrides": [3], "run": "a"}]}), "it is not a sweep's"),
        (sealed_json({"jobs": 3}), "it is not a sweep's"),
        (sealed_json({"jobs": [{"overrides": ["a=1"], "run": "a"}]}), "it is of another sweep than its folder is"),
    ],
)
def test_a_damaged_sweep_is_said(sweep, content, message):
    (sweep / "sweep.json").write_bytes(content)
    with pytest.raises(StoreError, match=message):
        open_runs(sweep)


def test_a_sweep_with_an_unfinished_run_says_how_to_continue(sweep):
    gone = open_runs(sweep)[1].folder
    (gone / "metrics.json").unlink()
    with pytest.raises(StoreError, match=r"1 of \d+ cells of .* are not stored; continue with: runner -m "):
        open_runs(sweep)


def test_a_folder_that_is_no_sweep(tmp_path):
    with pytest.raises(StoreError, match=r"is not a sweep: it has no sweep.json; `runner -m OVERRIDES` makes one"):
        open_sweep(tmp_path)


def test_a_sweep_in_another_sweeps_folder_is_damaged(sweep):
    other = sweep.rename(sweep.with_name("0" * 24))
    with pytest.raises(StoreError, match="it is of another sweep than its folder is named after"):
        open_sweep(other)


def test_a_good_run_in_a_shard_counts_before_a_failed_one_with_a_folder(sweep):
    first = open_runs(sweep)[0]
    write_shard(first.folder.parent.parent, "1-1", [Run(first.folder, first.config, dict(first.record), "<robot/>")])
    assert open_runs(sweep)[0].urdf != "<robot/>"
    failure = {"reason": "killed", "time": None, "joint": None, "repetition": None}
    record = {**first.record, "status": "failed", "failure": failure}
    write_job(first.folder, "metrics.json", {key: record[key] for key in record if key not in ("schema", "digest")}, {})
    assert open_runs(sweep)[0].urdf == "<robot/>"
