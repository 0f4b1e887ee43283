"""Caveats of stored runs without a trace."""

from runner.store import Finished
from runner.store.run import Run
from runner.store.shards import read_outcomes, shard_name, write_shard

MADE_BY = {
    "date": "2026-01-02", "command": "runner a", "commit": None, "versions": {}, "machine": "m", "seed": 3,
    "plant_step": 0.01, "warnings": [],
}  # fmt: skip
RECORD = {"status": "ok", "repetitions": 1, "caveats": [], "metrics": {}, "timing": {}, "provenance": MADE_BY}
CAVEAT = {"rule": "chatter", "text": "it chatters", "value": 0.5}


def make(outputs, name, **record):
    return Run(outputs / "runs" / name, {"seed": 3}, {**RECORD, **record}, "<robot/>")


def test_a_shard_carries_them(tmp_path):
    path = write_shard(tmp_path, shard_name(1, "a", 1), [make(tmp_path, "a", caveats=[CAVEAT]), make(tmp_path, "b")])
    assert [end.caveats for end in read_outcomes(path)] == [1, 0]
    assert Finished(tmp_path).open("a").caveats == [CAVEAT]
    assert Finished(tmp_path).open("b").caveats == []
