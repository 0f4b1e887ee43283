"""Shards: outcomes read back as written; damaged shards and rows are named."""

import re

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest

from runner.base.errors import StoreError
from runner.base.machine import Machine
from runner.store import DamagedError, Finished, RunOutcome, SchemaError, shards
from runner.store.parquet import encode_parquet
from runner.store.run import Run
from runner.store.shards import (
    ShardRow,
    find_shards,
    next_number,
    open_row,
    read_outcomes,
    shard_name,
    write_shard,
)

ENERGY = {"unit": "J", "values": [0.1], "median": 0.1, "min": 0.1, "max": 0.1}
RECORD = {"status": "ok", "repetitions": 1, "caveats": [], "metrics": {"energy": ENERGY}, "timing": {}}
MADE_BY = {
    "date": "2026-01-02", "commit": None, "versions": {}, "machine": "m", "seed": 3, "plant_step": 0.01, "warnings": [],
}  # fmt: skip
FAILURE = {"reason": "diverged", "time": 0.0, "joint": "q1", "repetition": 2}
CUT_SHORT = {"reason": "too long", "time": None, "joint": None, "repetition": None}


def make(outputs, name, failure=None, **record):
    more = {"status": "failed", "failure": failure} if failure else {}
    content = {**RECORD, **more, **record, "provenance": {**MADE_BY, "command": f"runner {name}"}}
    return Run(outputs / "runs" / name, {"seed": 3, "noise": {"position": 1e-4}}, content, "<robot/>")


def test_what_goes_in_comes_out(tmp_path):
    runs = [make(tmp_path, "a"), make(tmp_path, "b", FAILURE), make(tmp_path, "c", CUT_SHORT)]
    path = write_shard(tmp_path, shard_name(7, "a", 1), runs)
    finished = Finished(tmp_path)
    for run in runs:
        found = finished.open(run.hash)
        assert (found.hash, found.config, found.record, found.urdf) == (run.hash, run.config, run.record, run.urdf)
        assert found.folder == tmp_path / "runs" / run.hash
    assert [finished.outcome(name) for name in "abcd"] == [
        RunOutcome("a", "", False),
        RunOutcome("b", "failed in repetition 2 at t = 0 s (q1): diverged", False),
        RunOutcome("c", "cut short: too long", True),
        None,
    ]
    with pytest.raises(StoreError, match="no folder"):
        finished.open("d")
    assert list((tmp_path / "shards").iterdir()) == [path]
    assert path.name.startswith("00000000000000000007-a-000001.")
    assert find_shards(tmp_path, shard_name(7, "a", 1)) == [path]


def test_the_machine_of_each_run_is_kept_and_an_earlier_shard_has_none(tmp_path):
    runs = [make(tmp_path, name) for name in "abc"]
    machines = [Machine("Alpha", numpy="X86_V3"), Machine("Beta", numpy="X86_V4")]
    for run, machine in zip(runs, machines, strict=False):
        run.record["provenance"]["machine"] = machine.record()
    path = write_shard(tmp_path, shard_name(1, "a", 1), runs)
    finished = Finished(tmp_path)
    assert [finished.outcome(name).machine for name in "abc"] == [*machines, Machine("m")]
    table = pyarrow.parquet.read_table(path).drop_columns("machine")
    path.unlink()
    content = encode_parquet(table)
    path.with_name(f"1-1.{shards.digest(content)[:24]}.parquet").write_bytes(content)
    assert {Finished(tmp_path).outcome(name).machine for name in "abc"} == {Machine()}


def test_shards_are_numbered_without_a_clock(tmp_path):
    assert next_number(tmp_path) == 1
    write_shard(tmp_path, shard_name(1, "a", 3), [make(tmp_path, "a")])
    assert next_number(tmp_path) == 2
    (tmp_path / "shards" / "01795000000000000000-000001.parquet").touch()  # of the version that took the clock
    assert next_number(tmp_path) == 1795000000000000001
    assert shard_name(1795000000000000001, "a", 1) > "01795000000000000000-000001"


@pytest.mark.parametrize("numbers", [(1, 2), (2, 1)])
@pytest.mark.parametrize(
    ("worse", "better"), [(CUT_SHORT, None), (FAILURE, None), (CUT_SHORT, FAILURE)], ids=["good", "good2", "physics"]
)
def test_of_two_outcomes_the_better_counts_whichever_is_later(tmp_path, numbers, worse, better):
    for number, failure in zip(numbers, (worse, better), strict=True):
        write_shard(tmp_path, shard_name(number, "a", 1), [make(tmp_path, "a", failure), make(tmp_path, f"b{number}")])
    assert Finished(tmp_path).open("a").failure_record == better


def test_of_two_alike_the_later_counts(tmp_path):
    for number in (9, 10):
        again = {**CUT_SHORT, "reason": f"attempt {number}"}
        write_shard(tmp_path, shard_name(number, "a", 1), [make(tmp_path, "a", again)])
    assert Finished(tmp_path).outcome("a").failure == "cut short: attempt 10"


def test_a_run_without_trace_says_how_to_get_one(tmp_path):
    write_shard(tmp_path, "s", [make(tmp_path, "a")])
    with pytest.raises(StoreError, match=r"run a kept no trace \(sweep.trace\); .* with one: runner a"):
        _ = Finished(tmp_path).open("a").trace()


@pytest.mark.parametrize("content", [b"", b"PAR1", b"no parquet at all", "other"])
@pytest.mark.parametrize("name", ["s.0123456789.parquet", "s.parquet"])
def test_a_damaged_shard_is_named_with_the_way_out_and_counts_as_none(tmp_path, name, content):
    path = tmp_path / "shards" / name
    path.parent.mkdir()
    if content == "other":
        pyarrow.parquet.write_table(pyarrow.table({"run": ["a"]}), path)
    else:
        path.write_bytes(content)
    message = rf"{name}: .*; remove it, and the sweep's command simulates its"
    with pytest.raises(StoreError, match=message):
        read_outcomes(path)
    finished = Finished(tmp_path)
    assert finished.outcome("a") is None
    assert re.search(message, finished.damage[0])
    with pytest.raises(StoreError, match=message):
        finished.open("a")


def test_a_shard_whose_name_lost_its_digest_is_damaged(tmp_path):
    path = write_shard(tmp_path, "s", [make(tmp_path, "a")])
    with pytest.raises(DamagedError, match="its content has another digest than named"):
        read_outcomes(path.rename(path.with_name("s.parquet")))


def test_a_shard_of_another_schema_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(shards, "SCHEMA", 2)
    write_shard(tmp_path, "s", [make(tmp_path, "a")])
    monkeypatch.undo()
    with pytest.raises(
        SchemaError, match=r"s\..*\.parquet: it has schema 2, and this version reads schema 3; make it "
    ):
        Finished(tmp_path)


@pytest.mark.parametrize("record", ["{", "[" * 100_000])
def test_a_row_that_is_no_run_is_named(tmp_path, record):
    row = ShardRow(RunOutcome("a", "", False), "{}", "<robot/>", record, (), np.zeros((0, 0)))
    with pytest.raises(DamagedError, match=r"\.parquet: row 0 is not a run: "):
        open_row(write_shard(tmp_path, "s", [row]), 0)


def test_a_metric_without_its_column_is_named(tmp_path, monkeypatch):
    path = write_shard(tmp_path, "s", [make(tmp_path, "a")])
    monkeypatch.setattr(shards, "METRIC", "another ")
    with pytest.raises(DamagedError, match=r"row 0 is not a run: .*another energy"):
        open_row(path, 0)
