"""Ends of runs in a store: by name, and in shards."""

from runner.store import Finished, RunOutcome
from runner.store.names import Names
from runner.store.run import Run
from runner.store.shards import write_shard
from runner.sweeps.outcomes import Ends

NAMES = Names.of(["b" * 24, "a" * 24, "b" * 24, "c" * 24])


def test_ends_are_found_by_name_and_cells_of_one_run_are_counted_together():
    ends = Ends(NAMES)
    assert (len(ends), ends.left.tolist(), dict(ends)) == (0, [0, 1, 3], {})
    good, bad = RunOutcome("b" * 24, "", False, 2), RunOutcome("c" * 24, "cut short: late", True)
    ends.add([good, bad])
    assert dict(ends) == {good.name: good, bad.name: bad}
    assert (ends.left.tolist(), ends.failed.tolist(), ends.caveats.tolist()) == ([1], [3], [2, 2, 0])
    assert "a" * 24 not in ends
    assert "d" * 24 not in ends
    ends.add([RunOutcome("c" * 24, "", False)])
    assert ends.failed.tolist() == []
    assert ends["c" * 24].failure == ""


def test_ends_of_shards_are_taken_whole(tmp_path):
    failure = {"reason": "diverged", "time": 0.5, "joint": "q1", "repetition": 0}
    runs = [
        Run(
            tmp_path / "runs" / (letter * 24),
            {},
            {"status": "failed", "repetitions": 1, "caveats": [], "metrics": {}, "failure": found},
            "",
        )
        for letter, found in (("a", None), ("b", failure), ("d", failure))
    ]
    write_shard(tmp_path, "1-1", runs)
    finished, ends = Finished(tmp_path), Ends(NAMES)
    ends.add_stored(finished, finished.places(NAMES))
    assert dict(ends) == {name: finished.outcome(name) for name in ("a" * 24, "b" * 24)}
    assert ends["b" * 24].failure.startswith("failed in repetition 0")
