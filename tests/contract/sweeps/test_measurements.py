"""Axes and values of a sweep as arrays, against runs by hand, and what is missing or damaged in a stored sweep."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from runner.base.errors import StoreError
from runner.store import Run, open_sweep
from runner.sweeps.job import run as simulate
from runner.sweeps.measurements import measure, measure_run, measure_stored


def stored(name, metrics, status="ok"):
    """A run with the values of its metrics over the repetitions, never written to disk."""
    record = {
        "status": status,
        "repetitions": 2,
        "metrics": {metric: {"unit": "m", "values": values, "median": None, "min": None, "max": None}
                    for metric, values in metrics.items()},
        "caveats": [],
        "provenance": {"plant_step": 0.001, "commit": None, "seed": 0, "machine": name, "versions": {"numpy": "2"},
                       "date": "2026-11-21"},
    }  # fmt: skip
    if status == "failed":
        record["failure"] = {"repetition": 0, "time": 0.5, "joint": "q1", "reason": "diverged"}
    return Run(Path(name), {"plant": {"kind": "bullet"}}, record)


def axes_of(*jobs):
    measurements = measure(jobs, [stored("a", {})] * len(jobs))
    return {axis.name: (list(axis.values), axis.level.tolist()) for axis in measurements.axes}, measurements.fixed


def test_what_differs_is_an_axis_and_the_rest_is_fixed():
    jobs = [(f"noise.position={noise}", "robot=macro", "outputs=a") for noise in ("1e-3", "1e-4")]
    axes, fixed = axes_of(*jobs)
    assert axes == {"noise.position": ([1e-4, 1e-3], [1, 0])}
    assert fixed == ["robot=macro"]


def test_texts_stay_in_the_order_they_were_met():
    axes, _ = axes_of(
        ("controller.coupling=two_way",), ("controller.coupling=one_way",), ("controller.coupling='a b'",)
    )
    assert axes == {"controller.coupling": (["two_way", "one_way", "a b"], [0, 1, 2])}


@pytest.mark.parametrize("odd", ["null", "nan", "[1,2]", "{a: 1}"])
def test_an_axis_with_one_text_is_texts(odd):
    axes, _ = axes_of(("torque_limits.max=40",), (f"torque_limits.max={odd}",))
    assert axes["torque_limits.max"] == (["40", odd], [0, 1])


def test_one_number_written_in_two_ways_is_one_value():
    axes, _ = axes_of(
        ("noise.position=1e-3", "seed=0"), ("noise.position=0.001", "seed=1"), ("noise.position=2", "seed=0")
    )
    assert axes["noise.position"] == ([1e-3, 2.0], [0, 0, 1])


def test_how_a_sweep_is_run_is_no_axis():
    axes, fixed = axes_of(("sweep.trace=all", "outputs=a", "seed=0"), ("sweep.trace=never", "outputs=b", "seed=1"))
    assert list(axes) == ["seed"]
    assert fixed == []


def test_missing_values_tell_failure_from_absence():
    runs = [
        stored("a", {"settling_time": [1.0, None], "rms": [0.1, 0.2]}),
        stored("b", {"settling_time": [2.0, 3.0]}),
        stored("c", {}, "failed"),
        stored("d", {"settling_time": [None, 4.0]}, "failed"),
    ]
    measured = measure([(f"seed={seed}",) for seed in range(4)], runs)
    assert np.array_equal(
        measured.values["settling_time"], [[1, np.inf], [2, 3], [np.inf, np.inf], [np.inf, 4]], equal_nan=True
    )
    assert np.array_equal(
        measured.values["rms"], [[0.1, 0.2], [np.nan] * 2, [np.inf] * 2, [np.nan] * 2], equal_nan=True
    )
    assert measured.statuses == ["ok", "ok", "failed", "failed"]
    assert measured.failures[2] == "failed in repetition 0 at t = 0.5 s (q1): diverged"
    assert measured.provenance["machine"] == ["a", "b", "c", "d"]


def test_repetitions_may_differ_between_cells():
    runs = [stored("a", {"rms": [1.0, 2.0, 3.0]}), stored("b", {"rms": [4.0]})]
    measured = measure([("repetitions=3",), ("repetitions=1",)], runs)
    assert measured.repetitions == 3
    assert measured.of_cell("rms", 1).tolist() == [4.0]
    assert measured.medians("rms").tolist() == [2.0, 4.0]


@pytest.mark.parametrize("count", [1, 2, 5, 6])
def test_medians_are_those_of_numpy(count):
    values = np.random.default_rng(count).normal(size=(4, count))
    runs = [stored("a", {"rms": row.tolist()}) for row in values]
    measured = measure([(f"seed={seed}",) for seed in range(4)], runs)
    assert measured.medians("rms") == pytest.approx(np.median(values, axis=1), rel=1e-15)


def test_a_median_beyond_every_number_is_infinite_as_in_the_store():
    runs = [stored("a", {"rms": [1.0, None]}), stored("b", {"rms": [1.0, None, 2.0]})]
    assert measure([("seed=0",), ("seed=1",)], runs).medians("rms").tolist() == [np.inf, 2.0]


def test_the_same_repetition_of_one_seed_has_the_same_draws():
    metrics = {"rms": [1.0, 2.0]}
    runs = [stored(name, metrics) for name in "abc"]
    runs[2].record["provenance"]["seed"] = 7
    draws = measure([("robot=macro",), ("robot=mini",), ("robot=xarm7",)], runs).draws
    assert draws[0].tolist() == draws[1].tolist()
    assert len({*draws[0].tolist(), *draws[2].tolist()}) == 4


def test_what_is_stored_of_a_sweep_is_opened_and_what_is_missing_counted(copy_run, copy_sweep):
    folder = copy_sweep("goal", "other seed")
    whole = measure_stored(open_sweep(folder), "A")
    assert (len(whole.hashes), whole.missing, whole.failed) == (2, 0, 0)
    gone = copy_run("other seed")
    shutil.rmtree(gone)
    part = measure_stored(open_sweep(folder), "A")
    assert (part.hashes, part.missing) == ([copy_run("goal").name], 1)
    shutil.rmtree(gone.parent)
    with pytest.raises(StoreError, match="none of its 2 cells is stored; continue with: runner -m "):
        measure_stored(open_sweep(folder), "A")


def test_a_damaged_cell_is_left_out_and_told(copy_run, copy_sweep):
    folder = copy_sweep("goal", "other seed")
    (copy_run("other seed") / "metrics.json").write_text("{")
    part = measure_stored(open_sweep(folder), "A")
    assert part.missing == 1
    assert "metrics.json" in " ".join(part.damage)


def test_a_run_is_a_sweep_of_one_cell(runs):
    run = runs["goal"]
    side = measure_run(run, "B")
    assert (side.hashes, side.missing, side.folder) == ([run.hash], 0, run.folder)
    assert side.resolved("gravity") == [9.81]
    assert side.resolved("nothing.of.this") == [None]


def test_a_metric_that_a_run_does_not_define_is_not_beyond_every_number(tmp_path):
    """A run that ends before its motion has no steady state."""
    run = simulate("robot=macro", "trajectory=quintic", "duration=0.2", "plant=rk4", f"outputs={tmp_path}")
    values = measure_run(run, "A").values
    assert np.isnan(values["steady_state_error"]).all()
