"""Caveats of stored runs without a trace, and of runs older than caveats."""

import json

import pyarrow
import pyarrow.parquet
from support.engines import ASKED

from runner.execution import run
from runner.store import Finished, open_run
from runner.store.seal import digest, sealed_json
from runner.store.shards import ShardRun, read_outcomes, shard_files, shard_name, write_shard

RECORD = {"status": "ok", "repetitions": 1, "metrics": {}, "provenance": {"command": "runner a"}}
CAVEAT = {"rule": "chatter", "text": "it chatters", "value": 0.5, "repetitions": 1}


def make(outputs, name, **record):
    return ShardRun(outputs / "runs" / name, {"seed": 3}, {**RECORD, **record}, "<robot/>")


def test_a_shard_carries_them(tmp_path):
    path = write_shard(tmp_path, shard_name(1, 1), [make(tmp_path, "a", caveats=[CAVEAT]), make(tmp_path, "b")])
    assert [end.caveats for end in read_outcomes(path)] == [1, 0]
    assert Finished(tmp_path).open("a").caveats == [CAVEAT]
    assert Finished(tmp_path).open("b").caveats == ()


def test_a_shard_from_before_there_were_any_is_read(tmp_path):
    path = write_shard(tmp_path, shard_name(1, 1), [make(tmp_path, "a")])
    buffer = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.parquet.read_table(path).drop_columns(["caveats"]), buffer)
    content = buffer.getvalue().to_pybytes()
    path.unlink()
    (tmp_path / "shards" / f"{shard_name(1, 1)}.{digest(content)[:24]}.parquet").write_bytes(content)
    assert [end.caveats for end in read_outcomes(*shard_files(tmp_path))] == [0]
    found = Finished(tmp_path).open("a")
    assert (found.status, found.caveats, found.caveat_rules) == ("ok", (), None)


def test_a_run_from_before_there_were_any_is_read(tmp_path):
    made = run("robot=macro", ASKED, "duration=0.05", "noise.position=1e-3", f"outputs={tmp_path}")
    assert [caveat["rule"] for caveat in made.caveats] == ["did_not_follow", "exact_velocity"]
    path = made.folder / "metrics.json"
    skipped = ("schema", "digest", "caveats", "caveat_rules")
    path.write_bytes(
        sealed_json({key: value for key, value in json.loads(path.read_text()).items() if key not in skipped})
    )
    old = open_run(made.folder)
    assert (old.metrics, old.caveats, old.caveat_rules) == (made.metrics, (), None)
