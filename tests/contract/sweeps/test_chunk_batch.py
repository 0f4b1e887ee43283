"""Runs of a chunk that are simulated together: their choice, and the same outcomes as single runs."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from support.grids import plan_sweep

from runner import store
from runner.config.compose.composer import Composer
from runner.simulation import batch
from runner.store.seal import JsonTexts
from runner.sweeps import work
from runner.sweeps.batch import _rows
from runner.sweeps.check import check
from runner.sweeps.plan import Item, Listed
from runner.sweeps.queue import Queue
from runner.sweeps.run import make_rules
from runner.sweeps.work import Chunk

SHORT = ("robot=macro", "plant=rk4", "noise=thesis", "duration=0.05")
FAILING = (
    *("robot=macro", "plant=rk4", "controller.singularity_damping=0", "trajectory=quintic", "duration=1"),
    *("controller.period=0.06", "controller.natural_frequency=5,30,6,7"),  # the second one diverges
)


@pytest.fixture
def batches(monkeypatch):
    """Numbers of runs that were simulated together, call by call."""
    sizes, run_all = [], batch.run_all

    def note(loop_program, values, *others):
        sizes.append(len(values))
        return run_all(loop_program, values, *others)

    monkeypatch.setattr(batch, "run_all", note)
    return sizes


def whole_chunk(plan):
    """Return all cells of a plan as one chunk, as a queue hands them out that knows them to be fast."""
    checked = check(plan)
    store.prepare(checked.outputs)
    folder = store.write_sweep(checked.outputs, [(plan.overrides(n), checked.names[n]) for n in range(len(plan))], "x")
    rules = make_rules(checked.first.sweep, folder, len(plan), "a")
    queue = Queue(plan.alike, checked.names, checked.costs, np.arange(len(plan)), rules)
    return queue._chunk(range(len(plan)))


def by_name(outcomes):
    return {end.name: end for end in outcomes}


def alone(chunk, outputs):
    """Return the outcomes of the runs of a chunk if each is simulated separately, in another folder."""
    return by_name(
        end
        for part in chunk.parts
        for place, name in enumerate(part.names)
        for end in work.work(Chunk(f"9-{name}", chunk.rules, [work.SeedPart([name], [part.configs[place]])])).outcomes
    )


@pytest.mark.costs(2)
def test_a_sweep_makes_its_runs_together(sweep, batches, simulated_runs, monkeypatch):
    ticks = itertools.count(0.0, 0.001)
    monkeypatch.setattr(work, "time", SimpleNamespace(perf_counter=lambda: next(ticks)))
    given = [*SHORT, "seed=range(0,30)", "controller.natural_frequency=8,10", "sweep.trace=never"]
    ended = sweep(*given)
    made = [size for size in batches if size > 1]
    assert sum(made) >= 60 - 10  # all but the first, and some at the end that share what is left
    assert len(simulated_runs) == 60
    assert max(made) > 20
    assert len(list(store.open_sweep(ended.folder).runs())) == 60


def test_those_that_fail_and_those_that_do_not_end_as_alone(tmp_path, batches):
    chunk = whole_chunk(plan_sweep([*FAILING, "sweep.trace=never", f"outputs={tmp_path}/one"]))
    report = work.work(chunk)
    assert (batches, report.trouble) == ([4], "")
    other = whole_chunk(plan_sweep([*FAILING, "sweep.trace=never", f"outputs={tmp_path}/two"]))
    assert by_name(report.outcomes) == alone(other, tmp_path / "two")
    assert [end.failure.partition(" at ")[0] for end in report.outcomes if end.failure] == ["failed in repetition 0"]
    found = store.Finished(tmp_path / "one")
    assert sorted(found.names.astype(str)) == sorted(chunk.names)


def test_failed_runs_keep_their_traces_when_asked(tmp_path):
    chunk = whole_chunk(plan_sweep([*FAILING, "sweep.trace=failed", f"outputs={tmp_path}"]))
    (failed,) = [end.name for end in work.work(chunk).outcomes if end.failure]
    assert [path.name for path in (tmp_path / "runs").iterdir()] == [failed]
    run = store.open_run(tmp_path / "runs" / failed)
    assert run.trace()["t"].iloc[-1] == pytest.approx(run.failure_record["time"])


def test_runs_that_cannot_be_stored_together_are_made_one_by_one(tmp_path, batches, monkeypatch):
    def fall_over(*_):
        raise ValueError("a metric is infinite")

    monkeypatch.setattr("runner.sweeps.batch.record_texts", fall_over)
    chunk = whole_chunk(plan_sweep([*SHORT, "seed=range(0,5)", "sweep.trace=never", f"outputs={tmp_path}"]))
    report = work.work(chunk)
    assert batches[0] == 5
    assert sorted(by_name(report.outcomes)) == sorted(chunk.names)
    assert sorted(store.Finished(tmp_path).names.astype(str)) == sorted(chunk.names)


def test_an_infinite_metric_is_refused_as_in_a_run_alone():
    run = SimpleNamespace(names=("energy",), values=np.array([[np.inf]]))
    with pytest.raises(ValueError, match="infinite"):
        next(_rows([("a", run)], JsonTexts(), None))


@pytest.mark.costs(2)
def test_a_failure_stops_the_sweep_after_the_runs_that_were_made_with_it(sweep, batches, monkeypatch):
    ticks = itertools.count(0.0, 0.1)  # as if each chunk took 0.1 s: ten runs in the second one
    monkeypatch.setattr(work, "time", SimpleNamespace(perf_counter=lambda: next(ticks)))
    ended = sweep(*FAILING[:-1], "controller.natural_frequency=5,30", "seed=range(0,20)", "sweep.on_failure=stop")
    assert 1 <= len(ended.failures) < 20
    assert ended.left > 0
    assert len(ended.ends) == 40 - ended.left
    again = sweep(*FAILING[:-1], "controller.natural_frequency=5,30", "seed=range(0,20)")
    assert (len(again.failures), again.left) == (20, 0)


def test_a_chunk_holds_calibrations_too(tmp_path, batches):
    items = {f"run {n}": Item((*SHORT, f"seed={n}")) for n in range(5)}
    items["tool"] = Item(("calibration=tool_direction", "repetitions=2"), "calibrate")
    chunk = whole_chunk(Listed(items, ["sweep.trace=never", f"outputs={tmp_path}"], Composer()))
    report = work.work(chunk)
    assert [end.failure for end in report.outcomes] == [""] * 6
    assert batches == [5]
    assert len(store.Finished(tmp_path).names) == 5
    assert store.find_calibration(tmp_path, chunk.names[5]) is not None
    assert by_name(work.find_stored(chunk).values()) == by_name(report.outcomes)


MOODY = """
from typing import Literal
import numpy as np
from runner.plugins.registry import StrictModel


class CONFIG(StrictModel):
    kind: Literal["moody"]
    start: None
    height: float


class Moody:
    tracked, duration, run_duration = False, 0.0, 0.05

    def __init__(self, height, start):
        self.start = self.goal = start
        self.height = height

    def sample(self, times):
        motion = np.zeros((len(times), 3, 3))
        motion[:, 0] = self.start
        return motion

    def distance_to_path(self, points):
        away = np.linalg.norm(points - self.start, axis=1)
        if away.max() > self.height:
            raise RuntimeError("too far away for me")
        return away


def build(config, start):
    return Moody(config.height, start)
"""


def test_a_trajectory_that_raises_is_told_of_its_own_run_alone(own_part, tmp_path):
    folder = own_part("trajectory", "moody", MOODY, "kind: moody\nstart: null\nheight: 1.0\n")
    given = [*SHORT, "noise.position=0.01", "trajectory=moody", "trajectory.height=1.0,1e-9,2.0"]
    chunk = whole_chunk(plan_sweep([*given, "sweep.trace=never", f"outputs={tmp_path}"], [folder]))
    report = work.work(chunk)
    assert report.trouble == ""
    ends = by_name(report.outcomes)
    assert [bool(ends[name].failure) for name in chunk.names] == [False, True, False]
    assert "too far away for me" in ends[chunk.names[1]].failure
    assert "moody.py" in ends[chunk.names[1]].failure
