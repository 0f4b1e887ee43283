"""Runs on plant=bullet compiled as a whole have the bits of PyBullet's own steps, at joint limits, too."""

import numpy as np
import pytest

from runner.simulation.batch import BatchSimulator
from runner.simulation.run import simulate_repetition, simulate_run

pytest.importorskip("pybullet", reason="PyBullet is not installed")

MACRO = ("robot=macro", "plant=bullet", "noise=thesis", "duration=0.3")
FALLS = (  # onto its limits
    *("robot=so101", "plant=bullet", "noise=thesis", "controller.gravity_compensation=false"),
    *("controller.natural_frequency=1", "duration=1.5"),
)
CASES = {
    "coupled": ("robot=combined", "plant=bullet", "duration=0.05"),
    "delayed": (*MACRO, "plant.computation.delay=1"),
    "other law": (*MACRO, "controller=computed_torque", "torque_limits=thesis"),
    "differenced": (*MACRO, "noise.velocity=finite_difference"),
    "armature": (*MACRO, "robot.armature=0.05"),
    "wrong model": (*MACRO, "mismatch=sampled"),
}


@pytest.fixture
def by_pybullet(monkeypatch):
    """Simulate a repetition by PyBullet's own steps."""

    def simulate(config, repetition=0):
        with monkeypatch.context() as patch:
            patch.setattr("runner.plants.bullet.find_motion_of", lambda *_: None)
            patch.setattr("runner.plants.bullet.find_step", lambda *_: None)
            assert not is_whole(config)
            return simulate_repetition(config, repetition)

    return simulate


def is_whole(config):
    return BatchSimulator().repetitions(config) is not None


def assert_same(one, other):
    assert one.failure == other.failure
    for name in ("q", "dq", "tau", "end_points"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name


@pytest.mark.parametrize("case", CASES)
def test_runs_compiled_as_a_whole(case, checked_config, by_pybullet):
    config = checked_config(*CASES[case])
    assert is_whole(config)
    assert_same(simulate_repetition(config), by_pybullet(config))


@pytest.mark.parametrize("override", ["robot.friction.coulomb=0.5", "robot=combined plant.dynamics=decoupled"])
def test_what_is_simulated_tick_by_tick(override, checked_config):
    """Friction and mounted stages are interpreted around the step, by Pinocchio's dynamics."""
    assert not is_whole(checked_config(*MACRO, *override.split()))


@pytest.mark.costs(3)
def test_repetitions_at_a_limit_go_on_in_pybullet(checked_config, by_pybullet):
    config = checked_config(*FALLS, "repetitions=3")
    runs = BatchSimulator().repetitions(config)
    (early,) = BatchSimulator().simulate([run.first(40) for run in runs])
    found = list(BatchSimulator().simulate(runs))
    assert [len(each.places) for each in found] == [1, 1, 1]  # else one batch, as before the limit
    assert len(early.places) == 3
    for number, each in enumerate(found):
        trace = by_pybullet(config, number)
        assert_same(each.traces[0], trace)
        assert np.array_equal(early.traces[number].q, trace.q[:41])


def test_metrics_of_repetitions(checked_config, monkeypatch):
    config = checked_config(*MACRO, "repetitions=9")
    compiled = simulate_run(config).metrics
    monkeypatch.setattr("runner.plants.bullet.find_motion_of", lambda *_: None)
    interpreted = simulate_run(config).metrics
    assert compiled.keys() == interpreted.keys()
    for name, each in compiled.items():
        assert np.array_equal(each.values, interpreted[name].values, equal_nan=True), name
