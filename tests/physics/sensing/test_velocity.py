"""Velocity estimates against the transfer functions that they state."""

import numpy as np
import pytest
from scipy.signal import dlsim, dlti
from support.arms import checked

from runner.base.errors import ConfigError
from runner.sensing.encoders import EncoderNoise, JointEncoders
from runner.sensing.velocity import gains

H, W = 0.002, 150.0
WAYS = ("finite_difference", "low_pass", "luenberger")


def velocities(way, q, h=H, bandwidth=W, position=0.0):
    """Measure rows of true positions of one joint, and return the measured velocities."""
    noise = EncoderNoise(np.array([position]), np.zeros(1), np.zeros(1), "gaussian", way, bandwidth)
    sensor = JointEncoders(len(q), h, noise, np.random.default_rng(0))
    return np.array([sensor.measure(k, np.array([value]), np.array([9.0]))[1][0] for k, value in enumerate(q)])


def transfer_function(way):
    a, p = 1.0 - np.exp(-W * H), np.exp(-W * H)
    return {
        "finite_difference": ([1.0 / H, -1.0 / H], [1.0, 0.0]),
        "low_pass": ([a / H, -a / H], [1.0, a - 1.0]),
        "luenberger": ([(1.0 - p) ** 2 / H, -((1.0 - p) ** 2) / H, 0.0], [1.0, -2.0 * p, p * p]),
    }[way]


@pytest.mark.parametrize("way", WAYS)
def test_it_is_the_stated_transfer_function(way):
    q = np.random.default_rng(1).normal(size=300)
    q[0] = 0.0  # at rest before
    _, expected = dlsim(dlti(*transfer_function(way), dt=H), q)
    np.testing.assert_allclose(velocities(way, q), expected[:, 0], atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("way", WAYS)
def test_a_constant_velocity_is_exact_in_the_end(way):
    q = 0.3 + 1.7 * H * np.arange(2000)
    assert velocities(way, q)[-1] == pytest.approx(1.7, rel=1e-10)


@pytest.mark.parametrize("way", WAYS)
def test_a_constant_acceleration_is_late_by_the_stated_time(way):
    a, p = 1.0 - np.exp(-W * H), np.exp(-W * H)
    late = {"finite_difference": 0.0, "low_pass": H * (1.0 - a) / a, "luenberger": 2.0 * H * p / (1.0 - p)}[way]
    t = H * np.arange(2000)
    told = velocities(way, 0.5 * 4.0 * t**2)[-1]
    assert 4.0 * t[-1] - told == pytest.approx(4.0 * (0.5 * H + late), rel=1e-7)


def test_the_observer_converges_by_its_double_pole():
    # After a step of velocity the error is (1 + c k) p^k, which the first two measurements settle.
    p = np.exp(-W * H)
    error, k = 1.0 - velocities("luenberger", H * np.arange(30)), np.arange(30)
    np.testing.assert_allclose(error, (1.0 + (error[1] / p - 1.0) * k) * p**k, atol=1e-12)
    assert gains("luenberger", W, H) == pytest.approx((p**2, (1.0 - p) ** 2), rel=1e-14)


def test_a_fast_low_pass_and_observer_are_the_difference():
    q = np.random.default_rng(2).normal(size=50)
    for way in ("low_pass", "luenberger"):
        plain = velocities("finite_difference", q)
        np.testing.assert_allclose(velocities(way, q, bandwidth=1e6), plain, atol=1e-9 * np.abs(plain).max())


@pytest.mark.parametrize("way", WAYS)
def test_noise_has_the_variance_of_the_filter(way):
    numerator, denominator = transfer_function(way)
    impulse = dlti(numerator, denominator, dt=H).impulse(n=4000)[1][0][:, 0]
    told = velocities(way, np.zeros(40_000), position=1e-4)[1000:]
    assert told.std() == pytest.approx(1e-4 * np.sqrt((impulse**2).sum()), rel=0.05)


def test_at_rest_it_is_zero_from_the_first_tick_on():
    for way in WAYS:
        np.testing.assert_array_equal(velocities(way, np.full(5, 0.7)), np.zeros(5))


def test_a_bandwidth_must_be_above_zero_and_a_way_one_of_four():
    with pytest.raises(ConfigError, match=r"noise.velocity_bandwidth: must be above 0; found 0"):
        checked("noise.velocity_bandwidth=0")
    with pytest.raises(ConfigError, match=r"noise.velocity: found 'lowpass' \(did you mean low_pass\?\); allowed: "):
        checked("noise.velocity=lowpass")
