"""Integration error of a run: differences to Runge-Kutta, and the step that would do."""

import json
from dataclasses import replace

import numpy as np
import pytest

from runner.assembly.validation import validate
from runner.base.engines import has_pybullet
from runner.base.trace import Failure
from runner.caveats.integration_error import compare, on_runge_kutta, sufficient_step
from runner.config.compose.compose import compose
from runner.simulation.run import simulate_run
from runner.sweeps.job import run

CASE = ("robot=macro", "trajectory=quintic", "trajectory.duration=1", "duration=1.5")
OTHER = "bullet" if has_pybullet() else "mujoco"
BAND, STEP = 0.02, 0.01


def measured(tmp_path, *overrides):
    return run(*CASE, "plant_error=true", f"outputs={tmp_path}", *overrides)


@pytest.fixture(scope="module")
def simulated():
    """Repetition 0 of a case on Runge-Kutta: its trace and its metrics."""
    result = simulate_run(validate(compose((*CASE, "plant=rk4"))))
    return result.trace, {name: summary.median for name, summary in result.metrics.items()}


@pytest.mark.parametrize("plant", ["mujoco", pytest.param("bullet", marks=pytest.mark.bullet)])
def test_half_the_step_is_worth_half(tmp_path, plant):
    steps = (1e-3, 5e-4, 2.5e-4)
    errors = [measured(tmp_path, f"plant={plant}", f"plant.step={step}").plant_error for step in steps]
    for key in ("largest", "at"):
        assert all(error[key] > 0.0 for error in errors)
    largest = np.array([error["largest"] for error in errors])
    worth = np.array([error["metrics"]["rms_tracking_error"]["difference"] for error in errors])
    np.testing.assert_allclose(largest[1:] / largest[:-1], 0.5, rtol=0.05)
    assert (worth[1:] < 0.55 * worth[:-1]).all()  # of an error at right angles to the law's own it is a quarter
    assert len({error["metrics"]["rms_tracking_error"]["value"] for error in errors}) == 1


def test_a_run_that_diverges_is_compared_where_both_tips_are_finite(simulated):
    """A tip that leaves by 0.3 m, and then is not a number."""
    trace, metrics = simulated
    points = trace.end_points.copy()
    points[:, -3, 0] += 0.3
    points[:, -2:] = np.nan
    diverged = replace(trace, end_points=points, failure=Failure("diverged", float(trace.t[-1]), "q1"))
    error = compare(diverged, {}, trace, metrics, BAND, STEP)
    assert (error.largest, error.end) == (pytest.approx(0.3), pytest.approx(0.3))
    assert (error.at, error.parted) == (trace.t[-3], trace.t[-3])


def test_what_is_compared_is_the_run_on_runge_kutta(tmp_path):
    noisy = ("noise=thesis", "repetitions=3")
    own = measured(tmp_path, f"plant={OTHER}", *noisy)
    twin = run(*CASE, "plant=rk4", "noise=thesis", f"outputs={tmp_path}")
    error = own.plant_error
    assert (error["plant"], error["step"], error["parted"]) == ("rk4", 0.01, None)
    for name, worth in error["metrics"].items():
        value, first = twin.metrics[name].median, own.values(name)[0]
        assert worth["value"] == value
        assert worth["difference"] == abs(first - value)
        assert worth["share"] == (abs(first - value) / abs(first) if first else 0.0)
    rows = min(len(own.trace()), len(twin.trace()))
    tips = [stored.trace()[["tip_x", "tip_y", "tip_z"]].to_numpy()[:rows] for stored in (own, twin)]
    distance = np.linalg.norm(tips[0] - tips[1], axis=1)
    assert error["largest"] == distance.max()
    assert error["end"] == distance[-1]


def test_noise_is_the_same_on_both_plants(tmp_path):
    """Else the distance would have the size of the effect of noise."""
    error = measured(tmp_path, f"plant={OTHER}", "noise=thesis").plant_error
    other = run(*CASE, "plant=rk4", "noise=thesis", "seed=1", f"outputs={tmp_path}")
    same = run(*CASE, "plant=rk4", "noise=thesis", f"outputs={tmp_path}")
    tips = [stored.trace()[["tip_x", "tip_y", "tip_z"]].to_numpy() for stored in (other, same)]
    by_noise = np.linalg.norm(tips[0] - tips[1], axis=1)
    assert error["end"] < 0.1 * by_noise[-1]


def test_a_run_against_itself_is_worth_nothing(simulated):
    trace, metrics = simulated
    error = compare(trace, metrics, trace, metrics, BAND, STEP)
    assert (error.largest, error.end, error.parted) == (0.0, 0.0, None)
    assert {worth.share for worth in error.metrics.values()} == {0.0}


def test_motions_part_where_the_tips_are_four_bands_apart(simulated):
    trace, metrics = simulated
    moved = trace.end_points.copy()
    moved[-1, 40:45, 2] -= 3.9 * BAND
    moved[-1, 50:60, 0] += 4.1 * BAND
    moved[-1, 80, 1] += 5.0 * BAND
    error = compare(trace, metrics, replace(trace, end_points=moved), metrics, BAND, STEP)
    assert error.parted == trace.t[50]
    assert (error.at, error.largest) == (trace.t[80], pytest.approx(5.0 * BAND))
    assert error.end == 0.0
    assert {(worth.difference, worth.share) for worth in error.metrics.values()} == {(None, None)}
    assert error.metrics["max_tracking_error"].value == metrics["max_tracking_error"]


@pytest.mark.parametrize("fails", ["own", "other"])
def test_where_one_of_both_fails_they_part(simulated, fails):
    trace, metrics = simulated
    broken = trace.ended(Failure("diverged", float(trace.t[40])))
    given = (broken, {}, trace, metrics) if fails == "own" else (trace, metrics, broken, {})
    error = compare(*given, BAND, STEP)
    assert error.parted == trace.t[40]
    assert error.failure == ("diverged" if fails == "other" else "")
    assert all(worth.value is None for worth in error.metrics.values())


def test_both_may_fail_alike(simulated):
    trace, _ = simulated
    broken = trace.ended(Failure("diverged", float(trace.t[40])))
    assert compare(broken, {}, broken, {}, BAND, STEP).parted is None


def test_a_missing_value_is_not_compared(simulated):
    trace, metrics = simulated
    never = {**metrics, "settling_time": None}
    error = compare(trace, never, trace, metrics, BAND, STEP)
    assert error.metrics["settling_time"].share is None
    none = compare(trace, {"overshoot": 0.0}, trace, {"overshoot": 1e-3}, BAND, STEP).metrics["overshoot"]
    assert (none.difference, none.share) == (1e-3, None)


def test_the_config_of_the_other_run_is_what_hydra_composes():
    own = compose(("robot=combined", "plant=mujoco", "plant.friction.viscous=0.1", "plant_error=true", "repetitions=7"))
    other = compose(("robot=combined", "plant=rk4", "plant.friction.viscous=0.1"))
    assert on_runge_kutta(own.resolved) == other.resolved


@pytest.mark.parametrize("asked", [("plant=rk4", "plant_error=true"), (f"plant={OTHER}",)])
def test_nothing_is_stored_where_nobody_asks_or_nothing_is_to_be_compared(tmp_path, asked):
    stored = run("robot=macro", "duration=0.05", *asked, f"outputs={tmp_path}")
    assert stored.plant_error is None
    assert "plant_error" not in json.loads((stored.folder / "metrics.json").read_text())


def test_what_runge_kutta_cannot_make_is_told(tmp_path, monkeypatch):
    from runner.base.errors import ConfigError
    from runner.simulation import run as simulation

    def refuse(composed):
        if composed.resolved["plant"]["kind"] == "rk4":
            raise ConfigError(["plant.kind: rk4 cannot do that"])
        return validate(composed)

    monkeypatch.setattr(simulation, "validate", refuse)
    stored = measured(tmp_path, f"plant={OTHER}")
    assert stored.plant_error["plant"] == "rk4"
    assert "rk4 cannot do that" in stored.plant_error["reason"]
    assert not [caveat for caveat in stored.caveats if caveat["rule"] == "plant_error"]


def test_a_wall_is_not_smooth(tmp_path):
    wall = ("experiment=meca500/wall", f"plant={OTHER}", "plant.step=0.001", "duration=0.02", f"outputs={tmp_path}")
    assert "wall" in run(*wall).plant_error["reason"]
    pushed = ("experiment=meca500/push", f"plant={OTHER}", "plant.step=0.001", "duration=0.02", f"outputs={tmp_path}")
    assert run(*pushed).plant_error["metrics"]


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_the_step_that_would_do_makes_the_share_that_is_wanted(share):
    exact, step, period = 1.0, 1e-3, 0.01
    error = share / (1.0 - share) * exact  # of a metric of exact + error
    found = sufficient_step(step, share, 0.1, period)
    assert (period / found) == pytest.approx(round(period / found))
    left = error * found / step
    assert left / (exact + left) <= 0.1 + 1e-12
    larger = period / (round(period / found) - 1)
    assert error * larger / step / (exact + error * larger / step) > 0.1


def test_no_step_is_named_where_none_is_known_or_runge_kutta_is_cheaper():
    assert sufficient_step(1e-3, 1.5, 0.1, 0.01) is None
    assert sufficient_step(1e-3, 0.1, 0.0, 0.01) is None
    assert sufficient_step(1e-3, 0.9999, 0.1, 0.01) is None
