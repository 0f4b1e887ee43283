"""Lissajous figures: sines along each axis, crossings and distance."""

import numpy as np
import pytest

from runner.trajectories.lissajous import LissajousConfig, build

START = np.array([0.3, -0.2, 0.4])


def lissajous(amplitudes, frequencies, phases, easing="none"):
    config = LissajousConfig(
        kind="lissajous",
        start=None,
        amplitudes=amplitudes,
        frequencies=frequencies,
        phases=phases,
        easing=easing,
        duration=4.0,
    )
    return build(config, START)


def test_along_each_axis_it_is_a_sine_with_its_own_frequency():
    motion = lissajous([0.1, 0.2, 0.3], [1, 2, 3], [0.3, 0.0, -1.0]).sample(np.linspace(0.0, 8.0, 101))
    middle = START - np.array([0.1, 0.2, 0.3]) * np.sin([0.3, 0.0, -1.0])
    omega = 2.0 * np.pi / 4.0 * np.array([1, 2, 3])
    np.testing.assert_allclose(motion[:, 2], -(omega**2) * (motion[:, 0] - middle), atol=1e-12)
    energy = motion[:, 1] ** 2 + (omega * (motion[:, 0] - middle)) ** 2
    np.testing.assert_allclose(energy, np.tile((omega * [0.1, 0.2, 0.3]) ** 2, (101, 1)), rtol=1e-12)


@pytest.mark.parametrize("easing", ["quintic", "none"])
def test_an_eight_has_its_extent_and_crosses_itself(easing):
    eight = lissajous([0.1, 0.05, 0.0], [1, 2, 1], [np.pi / 2.0, 0.0, 0.0], easing)
    path = eight.sample(np.linspace(0.0, 4.0, 8_001))[:, 0]
    np.testing.assert_allclose(np.ptp(path, axis=0), [0.2, 0.1, 0.0], atol=1e-6)
    crossing = START - [0.1, 0.0, 0.0]
    near = np.linalg.norm(path - crossing, axis=1) < 1e-3
    assert (np.diff(near.astype(int)) == 1).sum() == 2
    assert eight.distance_to_path(crossing[None])[0] < 1e-16


def test_beside_a_crossing_the_nearer_branch_counts():
    eight = lissajous([0.1, 0.05, 0.0], [1, 2, 1], [np.pi / 2.0, 0.0, 0.0])
    u = np.concatenate([0.25 + np.linspace(-1e-3, 1e-3, 41), 0.75 + np.linspace(-1e-3, 1e-3, 41)])
    motion = eight.sample(4.0 * u)
    assert eight.distance_to_path(motion[:, 0]).max() < 1e-15
    across = np.cross(motion[:, 1], [0.0, 0.0, 1.0])
    across *= 1e-6 / np.linalg.norm(across, axis=1)[:, None]
    found = eight.distance_to_path(motion[:, 0] + across)
    assert (found <= 1e-6 + 1e-15).all()
    np.testing.assert_allclose(found[[0, 40, 41, 81]], 1e-6, rtol=1e-6)  # away from the crossing, its own branch


def test_with_equal_sines_a_quarter_apart_it_is_a_circle():
    circle = lissajous([0.1, 0.1, 0.0], [1, 1, 1], [np.pi / 2.0, 0.0, 0.0])
    random = np.random.default_rng(2)
    points = START + random.normal(size=(200, 3)) * 0.2
    from_centre = points - (START - [0.1, 0.0, 0.0])
    expected = np.hypot(np.hypot(from_centre[:, 0], from_centre[:, 1]) - 0.1, from_centre[:, 2])
    np.testing.assert_allclose(circle.distance_to_path(points), expected, atol=1e-12)
    assert circle.distance_to_path((START - [0.1, 0.0, 0.0])[None])[0] == pytest.approx(0.1, abs=1e-15)


def test_along_one_axis_it_is_a_segment():
    segment = lissajous([0.0, 0.1, 0.0], [1, 3, 1], [0.0, 0.0, 0.0])
    points = np.array([[0.0, 0.3, 0.0], [0.3, 0.1, 0.4], [0.0, -0.05, 0.2], [0.0, 0.1, 0.0], [0.3, -0.5, 0.0]])
    np.testing.assert_allclose(segment.distance_to_path(START + points), [0.2, 0.5, 0.2, 0.0, 0.5], atol=1e-9)


@pytest.mark.parametrize("frequency", [1, 7, 99])
def test_the_highest_frequency_is_resolved(frequency):
    wave = lissajous([0.2, 0.01, 0.0], [1, frequency, 1], [0.0, 0.0, 0.0])
    motion = wave.sample(np.linspace(0.5, 0.9, 53))
    across = np.cross(motion[:, 1], [0.0, 0.0, 1.0])
    offset = 1e-5 * across / np.linalg.norm(across, axis=1)[:, None]
    np.testing.assert_allclose(wave.distance_to_path(motion[:, 0] + offset), 1e-5, rtol=1e-9)
