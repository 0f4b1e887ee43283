"""Runs that are simulated together: each equals its single run to the last bit."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from support.arms import checked

from runner.assembly.drawn_loops import draws_together
from runner.assembly.validation import validate
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose
from runner.simulation import batch
from runner.simulation.batch import BatchResult, BatchSimulator, simulate_together
from runner.simulation.results import Collector
from runner.simulation.run import simulate_repetition
from runner.symbolic.engine import evaluator

pytestmark = pytest.mark.skipif(not evaluator(), reason="runs are compiled as a whole by llvmlite")
SCENE = "robot=macro", "plant=rk4", "controller=operational_space", "trajectory=quintic", "duration=0.4"
SIGNALS = "t", "q", "dq", "tau", "end_points", "desired", "limits", "offsets"


def configured(*overrides):
    return checked(*SCENE, *overrides)


def together(configs):
    """Return the trace of each repetition of each config, and how many runs were measured together."""
    batcher = BatchSimulator()
    runs = [run for config in configs for run in batcher.repetitions(config)]
    traces, counts = {}, []
    for found in batcher.simulate(runs):
        if isinstance(found, BatchResult):
            counts.append(len(found.places))
            traces |= {place: found.traces[row] for row, place in enumerate(found.places)}
            assert found.context.trajectory is runs[found.places[0]].config.path
        else:
            traces[found[0]] = found[1]
    return [traces[place] for place in range(len(runs))], counts


def alone(config, repetition=0):
    return simulate_repetition(config, repetition)


def assert_same(ours, theirs):
    for name in SIGNALS:
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), err_msg=name)
    assert ours.failure == theirs.failure
    assert len(ours.tick_seconds) == len(ours.t) - 1


def test_runs_that_differ_in_numbers_are_computed_together_and_are_those_alone():
    configs = [
        configured(f"controller.natural_frequency={gain}", f"noise.position={noise}", f"seed={seed}", *more)
        for gain, noise, seed, more in (
            (8, 1e-4, 0, ()),
            (8, 1e-3, 5, ("torque_limits.max=30",)),
            (12, 1e-4, 1, ("mismatch.mass=1.1",)),
            (9, 1e-4, 2**40, ("robot.payload.mass=0.5",)),
            (10, 2e-4, 3, ("trajectory.goal=[0.2,0.4,0.3]",)),
            (10, 2e-4, 3, ("duration=0.37",)),
        )
    ]
    found, _ = together(configs)
    for ours, config in zip(found, configs, strict=True):
        assert_same(ours, alone(config))
    assert len({tuple(trace.q[-1]) for trace in found}) == len(found)


def test_loops_keep_their_own_periods_and_encoders_their_own_steps():
    two = "robot=combined", "controller=macro_mini", "noise=thesis"
    configs = [
        configured(
            *two,
            f"controller.period={{macro: {macro}, mini: 0.002}}",
            f"noise.resolution={{macro: {step}, mini: {step}}}",
        )
        for macro in (0.01, 0.02, 0.04)
        for step in ("1e-5", "1e-3")
    ]
    found, _ = together(configs)
    for ours, config in zip(found, configs, strict=True):
        assert_same(ours, alone(config))


def test_repetitions_draw_their_own_noise_and_beliefs():
    config = configured("noise=thesis", "mismatch.mass=1.2", "mismatch.spread=0.1", "repetitions=11")
    found, counts = together([config])
    assert counts == [11]
    for repetition, ours in enumerate(found):
        assert_same(ours, alone(config, repetition))


@pytest.mark.parametrize(
    "overrides",
    [
        ("plant.computation.delay=3", "noise=thesis"),
        ("noise.velocity=finite_difference", "noise.resolution=1e-4", "noise.distribution=gaussian"),
        ("plant.friction.viscous=1", "plant.friction.coulomb=2", "plant.step=0.005"),
        ("robot=combined", "controller=macro_mini", "controller.period={macro: 0.02, mini: 0.002}", "noise=thesis"),
    ],
)
def test_what_acts_in_a_run_acts_in_a_batch(overrides):
    config = configured(*overrides, "repetitions=3")
    found, _ = together([config])
    for repetition, ours in enumerate(found):
        assert_same(ours, alone(config, repetition))


def test_a_run_that_fails_ends_alone():
    wild = configured("controller.natural_frequency=900", "controller.singularity_damping=0", "trajectory=goal")
    good = configured("trajectory=goal")
    found, _ = together([good, wild, good])
    assert "diverged" in found[1].failure.reason
    assert_same(found[1], alone(wild))
    for place in (0, 2):
        assert_same(found[place], alone(good))


def test_a_law_without_an_answer_ends_its_run(monkeypatch):
    config = configured("controller.singularity_damping=0", "duration=0.1")
    batcher = BatchSimulator()
    (run,) = batcher.repetitions(config)
    folded = batch.replace(run, q_start=np.array([0.0, 0.0, np.pi / 2]))
    ((place, trace),) = batcher.simulate([folded])
    assert (place, trace.failure.reason, trace.failure.time) == (0, "the tip's Jacobian is singular", 0.0)
    assert len(trace.t) == 1


def test_batches_are_cut_where_memory_would_not_hold_them(monkeypatch):
    config = configured("noise=thesis", "repetitions=20")
    whole, _ = together([config])
    monkeypatch.setattr(batch, "_MOST_BYTES", 100_000)
    parts, counts = together([config])
    assert max(counts) < 20
    for ours, theirs in zip(parts, whole, strict=True):
        assert_same(ours, theirs)


def test_runs_of_other_code_or_other_lengths_stand_in_other_batches():
    configs = [configured(), configured("controller.feedforward=false"), configured("duration=2")]
    found, counts = together(configs)
    assert counts == [1, 1, 1]
    for ours, config in zip(found, configs, strict=True):
        assert_same(ours, alone(config))


@pytest.mark.parametrize(
    "overrides",
    [("plant=mujoco",), ("environment=push",), ("robot=xarm7", "controller=differential_inverse_kinematics")],
)
def test_what_is_not_compiled_as_a_whole_goes_its_own_way(overrides):
    assert BatchSimulator().repetitions(configured(*overrides)) is None


def test_metrics_of_the_user_s_look_at_one_run_at_a_time(monkeypatch):
    config, seen, evaluate = configured("noise=thesis", "repetitions=3"), [], Collector.evaluate
    (whole,) = simulated_together(config)

    def noted(collector, repetition, trace, context):
        seen.append((repetition, trace.q.ndim))
        return evaluate(collector, repetition, trace, context)

    monkeypatch.setattr(batch, "added_parts", lambda group: (SimpleNamespace(name="mine"),))
    monkeypatch.setattr(Collector, "evaluate", noted)
    (found,) = simulated_together(config)
    assert seen == [(0, 2), (1, 2), (2, 2)]
    assert found.names == whole.names
    np.testing.assert_array_equal(found.values, whole.values)
    assert found.caveats == whole.caveats


def simulated_together(config):
    batcher = BatchSimulator()
    return [run for group in simulate_together([batcher.repetitions(config)], batcher) for run in group]


def test_what_runs_have_in_common_is_worked_out_once(monkeypatch):
    made = []
    whole = batch.assemble_program
    monkeypatch.setattr(batch, "assemble_program", lambda *given: made.append(1) or whole(*given))
    composed = compose([*SCENE, "noise=thesis"])
    batcher = BatchSimulator()
    for seed in range(5):
        batcher.repetitions(validate(replace(composed, resolved={**composed.resolved, "seed": seed})))
    assert len(made) == 1


LAW = """
    from typing import Literal

    from runner.controllers.operational_space.operational_space import OperationalSpace, OperationalSpaceConfig
    from runner.controllers.operational_space.operational_space import build, start_posture

    class Config(OperationalSpaceConfig):
        kind: Literal["same_law"]

    CONFIG = Config
"""


def test_repetitions_of_a_compiled_law_of_a_plug_in_with_drawn_models_are_those_alone(own_part):
    keys = yaml.safe_load((conf_dir() / "controller" / "operational_space.yaml").read_text())
    folder = own_part("controller", "same_law", LAW, yaml.safe_dump({**keys, "kind": "same_law"}))
    overrides = [*SCENE, "controller=same_law", "mismatch=sampled", "repetitions=3"]
    config = validate(compose(overrides, [folder]))
    assert not draws_together(config)
    traces, _ = together([config])
    for repetition, trace in enumerate(traces):
        assert_same(trace, alone(config, repetition))
    assert np.ptp([trace.q[-1, 0] for trace in traces]) > 0.0
