"""Metrics of several runs at once: each run's are the same to the last bit in whatever company."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.base.errors import SimulationError
from runner.base.trace import Trace
from runner.metrics.family import MetricContext
from runner.metrics.summary import evaluate, measure, of_run
from runner.trajectories import TRAJECTORIES
from runner.trajectories.circle import Circle
from runner.trajectories.goal import Goal
from runner.trajectories.lissajous import Lissajous
from runner.trajectories.motion import PathMotion, Segment, quintic_motion
from runner.trajectories.splines import minimum_jerk
from runner.trajectories.square import Square

A, B, C = np.array([0.1, -0.2, 0.3]), np.array([0.4, 0.15, 0.21]), np.array([0.2, 0.3, -0.1])
PATHS = {
    "goal": Goal(A, B),
    "quintic": quintic_motion(A, B, 1.3),
    "line": PathMotion(Segment(A, B), 1.9, "cosine"),
    "square": Square(np.array([A, B, C, A - B, A]), 1.5),
    "circle": PathMotion(Circle(A, 0.2, np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.6, 0.8]), 2), 1.5, "quintic"),
    "lissajous": PathMotion(
        Lissajous(A, np.array([0.1, 0.2, 0.05]), np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.3, 1.0])), 2.0, "none"
    ),
    "waypoints": minimum_jerk(np.array([A, B, C]), np.array([0.0, 0.7, 1.2])),
}
PATHS_AND_JOINTS = [(path, (1, 3, 6, 7)[(place + more) % 4]) for place, path in enumerate(PATHS) for more in (0, 2)]


def make_traces(runs=40, rows=201, joints=3, stages=("arm",), path="quintic", own_paths=False, units=None, seed=0):
    """Traces of runs that all differ, some of them at their limits, by chance."""
    draw = np.random.default_rng(seed)
    t = np.arange(rows) * 0.01
    desired = PATHS[path].sample(t)
    offsets = draw.normal(0.0, 0.1, (len(stages), 3))
    offsets[-1] = 0.0
    size = 10.0 ** draw.uniform(-4.0, -1.0, runs)
    size[: runs // 4] = 1e-3
    errors = size[:, None, None] * draw.normal(size=(len(stages), runs, rows, 3)) * np.exp(-5.0 * t)[:, None]
    limits = np.where(draw.random((runs, joints)) < 0.5, np.inf, draw.uniform(0.5, 3.0, (runs, joints)))
    return Trace(
        t=t,
        q=draw.normal(size=(runs, rows, joints)).cumsum(axis=1),
        dq=draw.normal(size=(runs, rows, joints)),
        tau=np.clip(draw.normal(size=(runs, rows, joints)), -limits[:, None], limits[:, None]),
        end_points=desired[:, 0] - offsets[:, None, None] - errors,
        offsets=offsets,
        stage_names=stages,
        desired=np.tile(desired, (runs, 1, 1, 1)) if own_paths else desired,
        limits=limits,
        joint_names=tuple(f"q{joint + 1}" for joint in range(joints)),
        joint_units=("rad",) * joints if units is None else units,
        tick_seconds=np.zeros(rows - 1),
    )


def chosen(traces, runs):
    """The traces of some runs, in a given order."""
    desired = traces.desired if traces.desired.ndim == 3 else traces.desired[runs]
    parts = {name: getattr(traces, name)[runs] for name in ("q", "dq", "tau", "limits")}
    return Trace(**{**vars(traces), **parts, "end_points": traces.end_points[:, runs], "desired": desired})


def context(path="quintic"):
    return MetricContext(PATHS[path], 2e-3, 0.01, reach=0.05)


@pytest.mark.parametrize(("path", "joints"), PATHS_AND_JOINTS)
def test_a_run_has_its_metrics_in_whatever_company(path, joints):
    units = tuple("m" if joint % 3 == 2 else "rad" for joint in range(joints))
    traces = make_traces(joints=joints, path=path, units=units)
    whole = measure(traces, context(path))
    order = np.random.default_rng(1).permutation(len(traces.q))
    for size in (1, 3, 8, 40):
        for first in range(0, min(len(order), 5 * size), size):
            runs = order[first : first + size]
            part = measure(chosen(traces, runs), context(path))
            assert list(part) == list(whole)
            for name, values in part.items():
                np.testing.assert_array_equal(values, whole[name][runs], err_msg=name)


@pytest.mark.parametrize("rows", [2, 3, 9, 130, 20_001])
@pytest.mark.parametrize("joints", [1, 2, 12])
def test_so_it_has_for_any_number_of_ticks(rows, joints):
    traces = make_traces(runs=5, rows=rows, joints=joints)
    whole = measure(traces, context())
    for run in range(5):
        alone = measure(chosen(traces, [run]), context())
        assert {name: values[0] for name, values in alone.items()} == pytest.approx(
            {name: values[run] for name, values in whole.items()}, rel=0.0, abs=0.0, nan_ok=True
        )


def test_so_it_has_with_stages_and_a_path_of_its_own():
    traces = make_traces(joints=6, stages=("macro", "mini"))
    own = make_traces(joints=6, stages=("macro", "mini"), own_paths=True)
    whole, of_own = measure(traces, context()), measure(own, context())
    assert {"macro_settling_time", "macro_rms_tracking_error", "reach_loss_fraction"} < set(whole)
    for run in range(0, len(traces.q), 7):
        alone = evaluate(own[run], context())
        assert alone == of_run(whole, run) == of_run(of_own, run)


def test_the_order_in_memory_does_not_matter():
    traces = make_traces()
    names = ("q", "dq", "tau", "end_points")
    turned = {name: np.ascontiguousarray(getattr(traces, name).swapaxes(-1, -2)).swapaxes(-1, -2) for name in names}
    first, second = measure(traces, context()), measure(Trace(**{**vars(traces), **turned}), context())
    for name, values in first.items():
        np.testing.assert_array_equal(second[name], values, err_msg=name)


def test_blocks_of_runs_are_put_together_again(monkeypatch):
    traces = make_traces()
    first = measure(traces, context())
    monkeypatch.setattr("runner.metrics.summary._BLOCK", 7 * 201 * 3)
    second = measure(traces, context())
    for name, values in first.items():
        np.testing.assert_array_equal(second[name], values, err_msg=name)


def test_a_run_that_never_settles_has_no_settling_time_beside_others_that_do():
    traces = make_traces(path="goal")
    errors = np.zeros((1, len(traces.q), len(traces.t), 3))
    errors[:, ::2, -1, 1] = 0.1
    found = measure(Trace(**{**vars(traces), "end_points": B - errors}), context("goal"))["settling_time"]
    np.testing.assert_array_equal(found[1::2], 0.0)
    assert np.isnan(found[::2]).all()


def test_a_trajectory_of_a_plug_in_is_asked_run_by_run():
    shapes = []

    def distance(points):
        shapes.append(points.shape)
        return PATHS["quintic"].distance_to_path(points)

    path = PATHS["quintic"]
    mine = SimpleNamespace(
        start=path.start, goal=path.goal, duration=1.3, run_duration=2.3, tracked=True, sample=path.sample,
        distance_to_path=distance,
    )  # fmt: skip
    guarded = MetricContext(TRAJECTORIES.guard(mine), 2e-3, 0.01)
    shapes.clear()
    traces = make_traces(runs=4)
    found = measure(traces, guarded)["cross_track_error"]
    assert shapes == [(201, 3)] * 4
    np.testing.assert_array_equal(found, measure(traces, context())["cross_track_error"])
    mine.distance_to_path = lambda points: np.full(len(points), np.nan)
    with pytest.raises(SimulationError, match="nan"):
        measure(traces, guarded)
