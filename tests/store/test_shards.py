import pytest

from runner.errors import StoreError
from runner.store import Outcome, Shards
from runner.store.shards import ShardRun, read_outcomes, shard_path, write_shard

RECORD = {"schema": 1, "status": "ok", "repetitions": 1, "metrics": {"energy": {"unit": "J", "median": 0.1}}}
FAILURE = {"reason": "diverged", "time": 0.0, "joint": "q1", "repetition": 2}
CUT_SHORT = {"reason": "too long", "time": None, "joint": None, "repetition": None}


def make(outputs, name, failure=None, **record):
    more = {"status": "failed", "failure": failure} if failure else {}
    content = {**RECORD, **more, **record, "provenance": {"command": f"runner {name}"}}
    return ShardRun(outputs / "runs" / name, {"seed": 3, "noise": {"position": 1e-4}}, content, "<robot/>")


def test_what_goes_in_comes_out(tmp_path):
    runs = [make(tmp_path, "a"), make(tmp_path, "b", FAILURE), make(tmp_path, "c", CUT_SHORT)]
    write_shard(shard_path(tmp_path, "s"), runs)
    shards = Shards(tmp_path)
    for run in runs:
        found = shards.open(run.hash)
        assert (found.hash, found.config, found.record, found.urdf) == (run.hash, run.config, run.record, run.urdf)
        assert found.folder == tmp_path / "runs" / run.hash
    assert [shards.outcome(name) for name in "abcd"] == [
        Outcome("a", "", False),
        Outcome("b", "failed in repetition 2 at t = 0 s (q1): diverged", False),
        Outcome("c", "cut short: too long", True),
        None,
    ]
    assert shards.open("d") is None
    assert [entry.name for entry in (tmp_path / "shards").iterdir()] == ["s.parquet"]


def test_a_later_shard_counts(tmp_path):
    write_shard(shard_path(tmp_path, "2"), [make(tmp_path, "a")])
    write_shard(shard_path(tmp_path, "1"), [make(tmp_path, "a", CUT_SHORT), make(tmp_path, "b")])
    assert Shards(tmp_path).outcome("a") == Outcome("a", "", False)
    assert Shards(tmp_path).open("a").status == "ok"


def test_a_run_without_trace_says_how_to_get_one(tmp_path):
    write_shard(shard_path(tmp_path, "s"), [make(tmp_path, "a")])
    with pytest.raises(StoreError, match=r"run a kept no trace \(sweep.trace\); .* with one: runner a"):
        _ = Shards(tmp_path).open("a").trace


@pytest.mark.parametrize("content", [b"", b"PAR1", b"no parquet at all"])
def test_a_damaged_shard_is_named_with_the_way_out(tmp_path, content):
    path = shard_path(tmp_path, "s")
    path.parent.mkdir()
    path.write_bytes(content)
    for look in (lambda: Shards(tmp_path), lambda: read_outcomes(path)):
        with pytest.raises(StoreError, match=r"s\.parquet: .*; remove it, and the sweep's command makes its"):
            look()
