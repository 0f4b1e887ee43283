"""Summary over repetitions: order, quantiles, missing values and units against NumPy."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.base.trace import Failure
from runner.metrics.family import MetricContext
from runner.metrics.summary import MOST_LISTED, evaluate, summarize_arrays
from runner.plugins.metric_units import units
from runner.trajectories.goal import Goal
from runner.trajectories.motion import quintic_motion

T = np.arange(401) * 0.01
TRACKED = MetricContext(quintic_motion(np.zeros(3), np.ones(3), 3.0), 0.02, 0.01)


def summarize(repetitions):
    names = tuple(dict.fromkeys(name for values in repetitions for name in values))
    rows = [[values.get(name) for name in names] for values in repetitions]
    return summarize_arrays(names, np.array(rows, dtype=float).reshape(len(rows), len(names)))


def summary(*values, name="settling_time"):
    return summarize([{name: value} for value in values])[name]


@pytest.mark.parametrize(
    ("values", "median", "least", "largest"),
    [
        ((1.0,), 1.0, 1.0, 1.0),
        ((3.0, 1.0, 2.0), 2.0, 1.0, 3.0),
        ((1.0, 2.0, 3.0, 4.0), 2.5, 1.0, 4.0),
        ((3.0, None, 1.0), 3.0, 1.0, None),  # the missing one counts as beyond every number
        ((1.0, 2.0, 4.0, None), 3.0, 1.0, None),
        ((1.0, 2.0, None, None), None, 1.0, None),  # half-way between a number and a missing one
        ((1.0, None), None, 1.0, None),
        ((None, None, 5.0), None, 5.0, None),
        ((None, None), None, None, None),
    ],
)
def test_missing_values_count_as_beyond_every_number(values, median, least, largest):
    found = summary(*values)
    assert (found.median, found.min, found.max) == (median, least, largest)
    assert tuple(found.record()["values"]) == values


def test_many_repetitions_have_quantiles_in_place_of_their_values():
    values = np.random.default_rng(0).permutation(MOST_LISTED + 1) + 1.0
    found = summary(*values)
    assert found.record() == {
        "unit": "s",
        **{"median": 1001.0, "min": 1.0, "max": 2001.0},
        "quantiles": {"0.01": 21.0, "0.05": 101.0, "0.25": 501.0, "0.75": 1501.0, "0.95": 1901.0, "0.99": 1981.0},
    }
    assert np.array_equal(found.values, values)
    assert "quantiles" not in summary(*values[:-1]).record()


@pytest.mark.parametrize("missing", [0, 20, 21, 22, 1001, 1981, 2500])
def test_quantiles_are_numpy_s_with_missing_values_beyond_every_number(missing):
    values = np.random.default_rng(missing).normal(size=2500)
    values[:missing] = np.nan
    found = summary(*[None if np.isnan(value) else value for value in values]).quantiles
    beyond = np.where(np.isnan(values), 1e300, values)
    for level, value in found.items():
        expected = np.quantile(beyond, float(level))
        assert value == (None if expected > 1e6 else pytest.approx(expected, rel=1e-12))


@given(st.lists(st.one_of(st.none(), st.floats(0.0, 1e6)), min_size=1, max_size=12), st.randoms())
def test_the_order_of_repetitions_does_not_matter(values, random):
    shuffled = values.copy()
    random.shuffle(shuffled)
    first, second = summary(*values), summary(*shuffled)
    assert (first.median, first.min, first.max) == (second.median, second.min, second.max)
    if first.median is not None:
        assert first.min <= first.median


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("settling_time", "s"),
        ("peak_torque", "N m"),
        ("peak_torque_q1", "N m"),
        ("rms_torque_shoulder_pan", "N m"),
        ("peak_joint_speed_q3", "rad/s"),
        ("max_tracking_error_x", "m"),
        ("saturation_fraction_q2", "1"),
        ("control_effort", "N^2 m^2 s"),
    ],
)
def test_names_with_a_suffix_share_the_unit(name, unit):
    assert summary(1.0, name=name).unit == unit


def test_no_metric_is_taken_for_another_s_suffix():
    for name, unit in units().items():
        assert summary(1.0, name=name).unit == unit


@pytest.mark.parametrize(
    "context", [TRACKED, MetricContext(Goal(np.zeros(3), np.ones(3)), 0.02, 0.01)], ids=["tracked", "goal"]
)
def test_every_metric_of_a_run_has_a_unit(hand_made_trace, context):
    found = summarize([evaluate(hand_made_trace(T, desired=1.0), context)])
    assert {name.removesuffix("_q1").removesuffix("_x") for name in found} <= set(found)
    assert all(value.unit for value in found.values())
    assert all(type(value.record()["values"][0]) in (float, type(None)) for value in found.values())
    assert ("max_tracking_error" in found) == (context is TRACKED)


def test_a_failed_run_has_no_metrics(hand_made_trace):
    failed = hand_made_trace(T, failure=Failure("diverged", 1.0, "q1"))
    assert evaluate(failed, TRACKED) == {}


@pytest.mark.parametrize("failed", [0, 1, 2])
def test_a_failed_repetition_gives_nulls(hand_made_trace, failed):
    good = evaluate(hand_made_trace(T, tip=1.0, desired=1.0), TRACKED)
    found = summarize([{} if repetition == failed else good for repetition in range(3)])
    assert list(found) == list(good)
    for name, value in found.items():
        assert np.isnan(value.values).tolist() == [good[name] is None or r == failed for r in range(3)]
        assert value.max is None
    assert found["settling_time"].median == 0.0


def test_a_carrier_is_judged_at_its_own_end_point_against_x_d_less_what_rides_on_it(hand_made_trace):
    path = np.outer(np.clip(T / 3.0, 0.0, 1.0), np.ones(3))  # along the desired line, a third a second
    offset, sag, miss = np.array([0.0, 0.1, 0.1]), np.array([0.0, 0.0, -0.03]), np.array([1e-3, 0.0, 0.0])
    trace = replace(
        hand_made_trace(T, desired=path),
        end_points=np.array([path - offset + sag, path + miss]),
        offsets=np.array([offset, np.zeros(3)]),
        stage_names=("macro", "mini"),
    )
    found = evaluate(trace, TRACKED)
    assert found["max_tracking_error"] == pytest.approx(1e-3)
    assert found["macro_max_axis_error"] == found["macro_max_tracking_error_z"] == pytest.approx(0.03)
    assert found["macro_max_tracking_error"] == pytest.approx(0.03)
    assert found["macro_max_tracking_error_x"] == pytest.approx(0.0, abs=1e-15)
    # Across the diagonal, whose share of the sag is a third of its square: of the line that starts at -offset.
    across = 0.03 * np.sqrt(2.0 / 3.0)
    assert found["macro_cross_track_error"] == pytest.approx(np.hypot(across, 0.03 / np.sqrt(3.0)), rel=1e-9)
    assert found["macro_settling_time"] is None
    assert found["settling_time"] == 0.0
    assert {name.removeprefix("macro_") for name in found if name.startswith("macro_")} < set(found)
    assert not {name for name in found if name.startswith("mini")}


def test_all_repetitions_failed():
    assert summarize([{}, {}]) == {}
