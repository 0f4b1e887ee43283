"""Runs that are read a shard at once measure what they do one by one."""

import numpy as np
import pytest

from runner import store
from runner.base.errors import StoreError
from runner.store import simulated_part
from runner.sweeps import gathering
from runner.sweeps.measurements import Measurements, measure, measure_sweep

MIXED = ("noise=thesis", "repetitions=2", "seed=range(0,3)")
DIVERGES = ("plant=rk4", "controller.singularity_damping=0", "trajectory=quintic", "controller.period=0.01,0.06")


def by_cell(configs):
    """Return the settings that determine each cell's results, without its seed; runs of a shard share the others."""
    parts = [({**simulated_part(config), "seed": None}, cells.tolist()) for config, cells in configs]
    return {cell: part for part, cells in parts for cell in cells}


def same(one, other):
    for key in Measurements.__dataclass_fields__:
        a, b = getattr(one, key), getattr(other, key)
        if key in ("folder", "command"):
            continue  # of the sweep
        if key in ("values", "undefined"):
            assert list(a) == list(b)
            assert all(np.array_equal(a[name], b[name], equal_nan=key == "values") for name in a)
        elif key == "axes":
            assert [(x.name, list(x.values), x.level.tolist()) for x in a] == [
                (x.name, list(x.values), x.level.tolist()) for x in b
            ]
        elif key == "configs":
            assert by_cell(a) == by_cell(b)
        elif key == "caveats":
            assert [list(found) for found in a] == [list(found) for found in b]
        else:
            assert (list(a) if key in ("seeds", "hashes") else a) == (list(b) if key in ("seeds", "hashes") else b), key


@pytest.mark.parametrize("trace", ["never", "failed"])
@pytest.mark.parametrize("axes", [("robot=macro,mini", "duration=0.05,0.1"), (*DIVERGES, "duration=1")], ids=len)
def test_shards_give_what_their_runs_do(sweep, monkeypatch, trace, axes):
    ended = sweep(*MIXED, *axes, f"sweep.trace={trace}")
    opened = store.open_sweep(ended.folder)
    one_by_one = measure(list(opened.overrides), opened.runs())
    given = []
    monkeypatch.setattr(gathering.Gathered, "add_run", lambda self, cell, run, add=gathering.Gathered.add_run: (
        given.append(run), add(self, cell, run)))  # fmt: skip
    same(measure_sweep(opened), one_by_one)
    assert all(run.folder.exists() for run in given)  # of a shard none is opened by itself
    assert len(given) == (len(ended.failures) if trace == "failed" else 0)


def test_a_seed_that_nobody_swept_is_told(sweep):
    first, second = (store.open_sweep(sweep("sweep.trace=never", f"seed={seed}").folder) for seed in (1, 2))
    jobs = [(("robot=macro",), first.hashes[0]), (("robot=macro",), second.hashes[0])]
    opened = store.open_sweep(store.write_sweep(first.outputs, jobs, "runner -m ..."))
    assert [difference.key for difference in measure_sweep(opened).differences] == ["seed"]


def test_a_missing_run_is_named(sweep):
    opened = store.open_sweep(sweep("seed=0,1", "sweep.trace=never").folder)
    for path in (opened.outputs / "shards").iterdir():
        path.unlink()
    with pytest.raises(StoreError, match=r"2 of 2 cells of .* are not stored; continue with: runner -m "):
        measure_sweep(opened)
