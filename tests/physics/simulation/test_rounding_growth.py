"""Repetition 0 from a moved start: against linear theory, in quiet and sensitive runs, and as stored."""

import json

import numpy as np
import pytest
from scipy.linalg import expm
from support.engines import ASKED

from runner.assembly.assemble import start_of
from runner.caveats.rounding_growth import SENSITIVE, move_start
from runner.sensing.streams import ROUNDING
from runner.simulation import run as simulation
from runner.simulation.run import measure_rounding, simulate_blocks
from runner.sweeps.job import run

LIMIT_CYCLE = ("robot=macro", "torque_limits.max=40", "controller.period=0.04")
NOISY = ("robot=macro", "trajectory=quintic", "trajectory.duration=0.4", "duration=0.5", "noise=thesis")
DIVERGING = ("robot=macro", "plant=rk4", "controller.natural_frequency=400", "plant_error=true", "duration=1")
COARSE = ("noise.resolution=1e-4", "noise.velocity=finite_difference")


def rules(stored):
    return [caveat["rule"] for caveat in stored.caveats]


def sensitive(growth):
    return {name for name, change in growth.metrics.items() if change > SENSITIVE}


@pytest.mark.parametrize("draw", [1, 2])
def test_an_arm_that_falls_from_its_equilibrium_follows_linear_theory(checked_config, draw):
    """M d'' = -K d about a configuration where constant torques carry the arm."""
    fall = ("robot=macro", "plant=rk4", "controller=held_torques", "noise=none", "duration=5")
    config = checked_config(*fall)
    model, q = config.arm.model, start_of(config)
    held = ",".join(map(repr, model.gravity_torque(q).tolist()))
    config = checked_config(*fall, f"controller.torques=[{held}]")
    slopes = [model.gravity_torque(q + 1e-6 * one) - model.gravity_torque(q - 1e-6 * one) for one in np.eye(3)]
    stiffness = np.array(slopes).T / 2e-6
    signs = np.random.default_rng([0, draw, ROUNDING]).choice([-1.0, 1.0], 3)
    start = move_start(q, signs) - q
    system = np.block(
        [[np.zeros((3, 3)), np.eye(3)], [-np.linalg.solve(model.mass_matrix(q), stiffness), np.zeros((3, 3))]]
    )
    end = expm(5.0 * system)[:3, :3] @ start
    growth = measure_rounding(config, draw=draw)
    assert growth.factor == pytest.approx(np.abs(end).max() / np.abs(start).max(), rel=0.05)
    assert growth.factor > 1e6
    assert growth.at == pytest.approx(5.0)


@pytest.mark.parametrize("plant", ["plant=rk4", ASKED])
def test_errors_grow_in_a_limit_cycle_and_stay_in_a_quiet_run(tmp_path, plant):
    outputs = f"outputs={tmp_path}"
    wild = run(*LIMIT_CYCLE, plant, "plant_error=true", outputs)
    assert wild.rounding["factor"] > 1e10
    assert max(wild.rounding["metrics"].values()) > 1e-3
    assert "rounding_grows" in rules(wild)
    quiet = run(*NOISY, plant, "plant_error=true", outputs)
    assert quiet.rounding["factor"] < 1e4
    assert max(quiet.rounding["metrics"].values()) < 1e-9
    assert "rounding_grows" not in rules(quiet)


def test_steps_of_an_encoder_are_found(checked_config):
    """No growth, but a jump by one step: joint positions differ by less than that, torques by per cents."""
    growth = measure_rounding(checked_config("robot=panda", "plant=rk4", *COARSE, "duration=3.5"))
    assert 1e8 < growth.factor < 1e12
    assert sensitive(growth)


def test_a_metric_of_the_size_of_rounding_is_not_sensitive(checked_config):
    growth = measure_rounding(checked_config("robot=macro", "plant=rk4", "noise=none", "duration=1"))
    assert not sensitive(growth)
    assert growth.failures == (None, None)


def test_noise_is_the_same_from_both_starts(checked_config):
    """Otherwise joint positions would differ by the effect of the noise."""
    for plant in ("plant=rk4", ASKED):
        assert measure_rounding(checked_config(*NOISY, plant)).factor < 1e4


def test_only_repetition_0_is_compared(tmp_path):
    one, more = (
        run(*LIMIT_CYCLE, "noise=thesis", "plant=rk4", "plant_error=true", f"repetitions={n}", f"outputs={tmp_path}")
        for n in (1, 3)
    )
    assert one.rounding == more.rounding
    assert set(more.rounding["metrics"]) == set(more.metrics)


def test_compiled_and_interpreted_loops_agree(checked_config, monkeypatch):
    """The draws of signs are the same, and so is what grows."""
    config = checked_config(*NOISY, "plant=rk4", "repetitions=2", "plant_error=true")
    whole = simulate_blocks(config).rounding
    monkeypatch.setattr(simulation.BatchSimulator, "repetitions", lambda *_: None)
    single = simulation.simulate_run(config).rounding
    assert whole.failures == single.failures
    assert max(whole.largest, single.largest) < 1e-9
    assert whole.metrics.keys() == single.metrics.keys()


def test_a_drawn_model_is_the_same_from_both_starts(checked_config):
    config = checked_config(*NOISY, ASKED, "mismatch.link.link3.inertia_spread=0.2")
    assert measure_rounding(config).factor < 1e4


def test_a_failure_at_the_same_time_is_no_change(tmp_path):
    same = run(*DIVERGING, f"outputs={tmp_path}")
    assert same.status == "failed"
    assert same.rounding["metrics"] == {}
    assert same.rounding["failures"] == [same.record["failure"]["time"]] * 2
    assert "rounding_grows" not in rules(same)


def test_a_failure_that_moves_is_marked(tmp_path, monkeypatch, checked_config):
    """The run from the moved start is replaced by one that ends without a failure."""
    simulate, good = simulation.simulate_repetition, checked_config(*NOISY, "plant=rk4")
    monkeypatch.setattr(simulation, "simulate_repetition", lambda config, **given: simulate(good, **given))
    failed = run(*DIVERGING, f"outputs={tmp_path}")
    assert failed.rounding["failures"] == [failed.record["failure"]["time"], None]
    assert "rounding_grows" in rules(failed)


def test_a_run_that_does_not_ask_is_not_made_again(tmp_path, monkeypatch):
    monkeypatch.setattr(simulation, "measure_rounding", None)
    for plant in ("plant=rk4", ASKED):
        stored = run(*NOISY, plant, f"outputs={tmp_path}")
        assert stored.rounding is None
        assert "rounding" not in json.loads((stored.folder / "metrics.json").read_text())
