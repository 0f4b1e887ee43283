"""Wrist sensor: frame, noise, drift, low-pass and range of readings against closed forms."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from runner.sensing.force_torque import ForceTorqueConfig, ForceTorqueSensor

PERIOD = 0.001
WRENCH = np.array([1.0, -2.0, 3.0, 0.1, -0.2, 0.3])
IDEAL = {
    "range": [20.0, 20.0, 60.0, 1.0, 1.0, 1.0],
    "resolution": [0.0] * 6,
    "noise": [0.0] * 6,
    "bias": [0.0] * 6,
    "drift": [0.0] * 6,
    "low_pass": None,
    "rotation": 0.0,
    "height": 0.0,
    "mass": 0.0499,
}
RESOLUTION = [0.005, 0.005, 0.01, 0.000125, 0.000125, 0.000125]
NOISE = [0.0075, 0.0075, 0.015, 0.0001875, 0.0001875, 0.0001875]


def make(ticks=10, seed=0, period=PERIOD, **changes):
    return ForceTorqueSensor(ticks, period, ForceTorqueConfig(**(IDEAL | changes)), np.random.default_rng(seed))


def read(wrenches, **changes):
    sensor = make(len(wrenches), **changes)
    return np.array([sensor.read(tick, wrench) for tick, wrench in enumerate(wrenches)])


def at_rest(ticks=20_000, wrench=(0.0,) * 6, **changes):
    return read(np.tile(wrench, (ticks, 1)), **changes)


def test_an_ideal_sensor_on_the_flange_reads_the_wrench():
    np.testing.assert_array_equal(at_rest(3, WRENCH), np.tile(WRENCH, (3, 1)))


def test_the_bias_is_added():
    bias = [0.5, -0.4, 0.3, 0.01, 0.02, -0.03]
    np.testing.assert_allclose(at_rest(1, WRENCH, bias=bias)[0], WRENCH + bias, atol=1e-15)


def test_a_turned_sensor_reads_along_its_own_axes():
    turned = Rotation.from_rotvec([0.0, 0.0, 0.7]).inv()
    expected = np.concatenate([turned.apply(WRENCH[:3]), turned.apply(WRENCH[3:])])
    np.testing.assert_allclose(at_rest(1, WRENCH, rotation=0.7)[0], expected, atol=1e-15)


def test_a_force_through_the_sensor_s_origin_has_no_moment_there():
    lever, force = np.array([0.0, 0.0, 0.0122]), WRENCH[:3]
    wrench = np.concatenate([force, np.cross(lever, force)])
    (reading,) = at_rest(1, wrench, height=0.0122, rotation=0.3)
    assert np.linalg.norm(reading[:3]) == pytest.approx(np.linalg.norm(force))
    np.testing.assert_allclose(reading[3:], np.zeros(3), atol=1e-16)


def test_noise_has_its_standard_deviation_and_a_draw_of_its_own_per_axis_and_tick():
    found = at_rest(noise=NOISE)
    np.testing.assert_allclose(found.std(axis=0), NOISE, rtol=0.02)
    correlation = np.corrcoef(np.hstack([found[:-1], found[1:]]).T)
    assert np.abs(correlation - np.eye(12)).max() < 4.5 / np.sqrt(len(found))


def test_readings_are_whole_steps_of_the_resolution_and_off_by_half_of_one_at_most():
    wrenches = np.random.default_rng(1).uniform(-0.9, 0.9, (500, 6))
    found = read(wrenches, resolution=RESOLUTION)
    np.testing.assert_allclose(found / RESOLUTION, np.round(found / RESOLUTION), atol=1e-9)
    shares = np.abs(found - wrenches) / RESOLUTION
    assert shares.max() <= 0.5 + 1e-9
    assert shares.max() > 0.49


def test_the_variance_of_a_mean_is_that_of_noise_and_rounding():
    config = {"noise": NOISE, "resolution": RESOLUTION}
    readings = at_rest(100_000, WRENCH + 0.0021, **config)
    for samples in (1, 50):
        expected = ForceTorqueConfig(**(IDEAL | config)).reading_variance(samples)
        means = readings.reshape(-1, samples, 6).mean(axis=1)
        np.testing.assert_allclose(means.var(axis=0), expected, rtol=4.0 * np.sqrt(2.0 / len(means)))


def test_drift_is_a_random_walk_of_the_bias():
    drift, ticks = [0.02] * 6, 101  # a tenth of a second
    walks = np.array([at_rest(ticks, drift=drift, seed=seed) for seed in range(100)])
    np.testing.assert_array_equal(walks[:, 0], np.zeros((100, 6)))
    for tick in (25, 100):
        expected = 0.02 * np.sqrt(tick * PERIOD)
        assert walks[:, tick].std() == pytest.approx(expected, rel=4.0 / np.sqrt(2 * 600))


def test_drift_of_a_second_does_not_hang_on_the_rate():
    slow = np.array([at_rest(11, drift=[0.02] * 6, period=0.1, seed=seed)[-1] for seed in range(200)])
    assert slow.std() == pytest.approx(0.02, rel=4.0 / np.sqrt(2 * 1200))


@pytest.mark.parametrize("period", [1e-4, 1e-3, 5e-3])
def test_the_low_pass_follows_a_step_as_a_first_order_lag(period):
    wrenches = np.vstack([np.zeros((1, 6)), np.tile(WRENCH, (40, 1))])
    found = read(wrenches, low_pass=30.0, period=period)
    times = period * np.arange(41)[:, None]  # the step comes at the first tick and is held from there on
    np.testing.assert_allclose(found, WRENCH * -np.expm1(-2.0 * np.pi * 30.0 * times), atol=1e-14)


def test_the_low_pass_starts_settled():
    np.testing.assert_allclose(at_rest(5, WRENCH, low_pass=30.0), np.tile(WRENCH, (5, 1)), atol=1e-15)


def test_noise_is_added_behind_the_low_pass_and_leaves_no_trace_in_it():
    wrenches = np.random.default_rng(1).normal(size=(200, 6))
    slow = {"low_pass": 5.0, "range": 6 * [1e9]}  # keeps 97 % of what it holds from one tick to the next
    noise = at_rest(200, noise=NOISE)
    np.testing.assert_allclose(at_rest(200, noise=NOISE, **slow), noise, atol=1e-15)
    np.testing.assert_allclose(read(wrenches, noise=NOISE, **slow) - read(wrenches, **slow), noise, atol=1e-12)


def test_rounding_and_range_stand_behind_the_low_pass():
    wrenches = np.random.default_rng(1).normal(scale=20.0, size=(200, 6))
    behind = {"resolution": 6 * [0.5], "range": 6 * [2.0]}
    smooth = read(wrenches, low_pass=5.0, range=6 * [1e9])
    expected = np.clip(0.5 * np.round(smooth / 0.5), -2.0, 2.0)
    np.testing.assert_allclose(read(wrenches, low_pass=5.0, **behind), expected, atol=1e-12)
    assert (np.abs(smooth) > 2.0).any()


def test_the_drifting_bias_passes_the_low_pass():
    drift, cut_off, ticks = [0.5] * 6, 30.0, 300
    seen = at_rest(ticks, drift=drift)  # the walk itself, which starts at zero
    share = -np.expm1(-2.0 * np.pi * cut_off * PERIOD)
    for tick in range(1, ticks):
        seen[tick] = seen[tick - 1] + share * (seen[tick] - seen[tick - 1])
    np.testing.assert_allclose(at_rest(ticks, drift=drift, low_pass=cut_off), seen, atol=1e-12)


def test_an_overload_reads_the_range_and_is_named():
    wrenches = np.zeros((3, 6))
    wrenches[1] = [25.0, -19.0, -75.0, 0.5, 0.0, -1.5]
    sensor = make(3)
    found = np.array([sensor.read(tick, wrench) for tick, wrench in enumerate(wrenches)])
    np.testing.assert_array_equal(found[1], [20.0, -19.0, -60.0, 0.5, 0.0, -1.0])
    np.testing.assert_array_equal(found[2], np.zeros(6))
    assert sensor.overloads() == [
        "Fx reached 25 N, beyond the sensor's range of 20 N; its reading stayed there",
        "Fz reached 75 N, beyond the sensor's range of 60 N; its reading stayed there",
        "Mz reached 1.5 N m, beyond the sensor's range of 1 N m; its reading stayed there",
    ]


def test_the_bias_takes_its_part_of_the_range():
    sensor = make(1, bias=[5.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert sensor.read(0, np.array([16.0, 0.0, 0.0, 0.0, 0.0, 0.0]))[0] == 20.0
    assert len(sensor.overloads()) == 1


def test_a_load_at_the_range_is_no_overload():
    sensor = make(1)
    sensor.read(0, np.array(IDEAL["range"]))
    assert sensor.overloads() == []


def test_the_generator_alone_decides_the_draws_and_a_longer_run_starts_alike():
    config = {"noise": NOISE, "drift": [0.02] * 6}
    first = at_rest(100, **config)
    np.testing.assert_array_equal(at_rest(100, **config), first)
    np.testing.assert_array_equal(at_rest(500, **config)[:100], first)
    assert not np.array_equal(at_rest(100, seed=1, **config), first)


def test_the_wrench_and_what_was_read_before_stay_as_they_are():
    sensor, wrench = make(low_pass=30.0, noise=NOISE, resolution=RESOLUTION), WRENCH.copy()
    wrench.setflags(write=False)
    first = sensor.read(0, wrench)
    kept = first.copy()
    sensor.read(1, 2.0 * wrench)
    np.testing.assert_array_equal(first, kept)


@pytest.mark.parametrize(
    "changes",
    [
        {"range": [20.0] * 5},
        {"range": [0.0] * 6},
        {"noise": [-1e-3] * 6},
        {"resolution": [float("nan")] * 6},
        {"low_pass": 0.0},
        {"mass": -0.1},
        {"gain": 1.0},
    ],
)
def test_impossible_numbers_are_refused(changes):
    with pytest.raises(ValidationError, match=next(iter(changes))):
        ForceTorqueConfig(**(IDEAL | changes))
