"""Division of the jobs of a sweep into chunks."""

import numpy as np
import pytest

from runner.config.composed import Composed
from runner.config.limits import SweepConfig
from runner.store import RunOutcome
from runner.sweeps import queue as queues
from runner.sweeps.queue import Queue
from runner.sweeps.work import ChunkResult
from runner.sweeps.writer import Rules

SETTINGS = SweepConfig(trace="auto", retry="none", on_failure="continue", attempts=1, time_limit=None, part=None)


def alike(cells):
    return (([cell], [Composed({"seed": cell}, (), {}, ())]) for cell in cells)


def queue_of(tmp_path, costs):
    rules = Rules((), tmp_path, tmp_path, "never", SETTINGS, True)
    names = [f"{cell:024x}" for cell in range(len(costs))]
    return Queue(alike, names, costs, np.arange(len(costs)), rules)


def drain(tmp_path, costs, seconds_per_tick, workers=2):
    """Return the cells of each chunk, as a worker of some speed would get them."""
    queue = queue_of(tmp_path, costs)
    chunks = []
    for chunk in iter(lambda: queue.take(workers), None):
        cells = [int(name, 16) for name, _ in chunk.jobs]
        chunks.append(cells)
        ends = [RunOutcome(name, "", False) for name, _ in chunk.jobs]
        queue.end(chunk)
        queue.learn(ChunkResult(ends, "", seconds_per_tick * sum(costs[cell] for cell in cells)))
    assert queue.ticks_made == sum(costs)
    return chunks


def test_every_cell_is_handed_out_once_in_order(tmp_path):
    chunks = drain(tmp_path, [100] * 1000, 1e-5)
    assert [cell for cells in chunks for cell in cells] == [*range(1000)]
    assert len(chunks[0]) == 1
    assert len(chunks[1]) == pytest.approx(1000 / 4, abs=2)  # a fair share, which takes less than a second
    assert max(map(len, chunks[-4:])) <= 2


def test_chunks_take_about_a_second(tmp_path):
    chunks = drain(tmp_path, [1000] * 1000, 1e-4)
    assert {len(cells) for cells in chunks[1:-20]} == {10}


def test_slow_jobs_of_a_large_sweep_make_no_more_chunks_than_allowed(tmp_path, monkeypatch):
    monkeypatch.setattr(queues, "_MOST_CHUNKS", 20)
    chunks = drain(tmp_path, [1000] * 1000, 1.0)
    assert {len(cells) for cells in chunks[1:-1]} == {50}
    assert len(chunks) == 21


def test_fast_jobs_make_chunks_up_to_a_size(tmp_path, monkeypatch):
    monkeypatch.setattr(queues, "_LARGEST", 30)
    assert max(map(len, drain(tmp_path, [1] * 1000, 1e-7))) == 30


def test_a_job_above_the_share_goes_alone(tmp_path):
    assert [len(cells) for cells in drain(tmp_path, [10**6, 10**6, 10, 10], 1e-4)[:3]] == [1, 1, 1]


def test_ticks_of_chunks_under_way_count_until_the_chunk_has_ended(tmp_path):
    queue = queue_of(tmp_path, [100, 200, 300])
    first, second = queue.take(2), queue.take(2)
    queue.tell(first.name, 40)
    queue.tell(second.name, 70)
    assert queue.ticks_made == 110
    queue.end(first)
    queue.learn(ChunkResult([RunOutcome(name, "", False) for name in first.names], "", 1.0))
    queue.tell(first.name, 90)  # reported late
    assert queue.ticks_made == 100 + 70


def test_a_single_worker_shares_with_nobody(tmp_path):
    assert [len(cells) for cells in drain(tmp_path, [100] * 250, 1e-5, workers=1)] == [1, 249]
    assert len(drain(tmp_path, [100] * 250, 1e-3, workers=1)) == pytest.approx(25, abs=3)  # a second each
