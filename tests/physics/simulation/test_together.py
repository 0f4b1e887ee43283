"""Stored runs that were simulated together against the same runs one by one."""

import pytest

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.simulation.batch import BatchSimulator, simulate_together
from runner.simulation.run import simulate_run
from runner.sweeps.records import make_record
from runner.symbolic.engine import evaluator

pytestmark = pytest.mark.skipif(not evaluator(), reason="runs are compiled as a whole by llvmlite")
SCENE = "robot=macro", "plant=rk4", "controller=operational_space", "noise=thesis", "torque_limits=thesis"
TIMED = ("timing", "provenance")


def job(*overrides):
    return validate(compose([*SCENE, *overrides]))


def record(result):
    return {key: value for key, value in make_record(result).items() if key not in TIMED}


def one_by_one(monkeypatch, config):
    with monkeypatch.context() as apart:
        apart.setattr(BatchSimulator, "repetitions", lambda *_: None)
        return simulate_run(config)


@pytest.mark.parametrize(
    "overrides",
    [
        ("trajectory=quintic", "duration=3", "repetitions=7"),
        ("trajectory=circle", "duration=1"),
        ("trajectory=goal", "duration=1", "repetitions=3", "noise.position=3", "controller.natural_frequency=90"),
        ("robot=combined", "controller=macro_mini", "duration=0.3", "repetitions=2"),
    ],
)
def test_a_run_s_record_is_the_same_together_and_one_by_one(monkeypatch, overrides):
    config = job(*overrides)
    assert record(simulate_run(config)) == record(one_by_one(monkeypatch, config))


def test_runs_are_complete_once_all_their_repetitions_have_ended(monkeypatch):
    jobs = [
        job("duration=0.5", "repetitions=3"),
        job(
            "duration=0.5",
            "repetitions=2",
            "trajectory=goal",
            "controller.natural_frequency=900",
            "torque_limits=none",
        ),
        job("duration=0.5", "seed=9"),
        job("duration=2"),
    ]
    batcher = BatchSimulator()
    runs = [batcher.repetitions(config) for config in jobs]
    found = {run.place: run for some in simulate_together(runs, batcher) for run in some}
    assert sorted(found) == [0, 1, 2, 3]
    for place, config in enumerate(jobs):
        ours = found[place].result()
        assert record(ours) == record(one_by_one(monkeypatch, config))
        assert ours.provenance["command"] == f"runner {' '.join(config.composed.overrides)}"
        assert ours.timing["wall_s"] > 0.0
    assert found[1].failure[0] == 0
