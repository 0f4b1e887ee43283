"""Identification of a tool's weight: estimates and covariance against the true tool, exact and noisy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.special import ndtri
from support.turns import rotation

from runner.base.errors import ConfigError
from runner.calibration.gravity import PARAMETERS, REST, Tool, identify_gravity
from runner.calibration.orientations import choose_orientations
from runner.calibration.uncertainty import consistency, pose_covariances
from runner.sensing.force_torque import ForceTorqueConfig, ForceTorqueSensor
from runner.sensing.wrench import wrench_transform

GRAVITY = 9.81
TOOL = Tool(0.25, np.array([0.004, -0.007, 0.031]), 1e-4 * np.eye(3))
BIAS = np.array([0.8, -1.3, 2.1, 0.012, -0.02, 0.008])
THETA = 0.35
TRUTH = np.concatenate([[TOOL.mass, THETA], TOOL.centre_of_mass, BIAS])
NO_NOISE = np.zeros(6)


def mini40(**changes):
    config = {
        "range": [20.0, 20.0, 60.0, 1.0, 1.0, 1.0],
        "resolution": [0.005, 0.005, 0.01, 0.000125, 0.000125, 0.000125],
        "noise": [0.0075, 0.0075, 0.015, 0.0001875, 0.0001875, 0.0001875],
        "bias": BIAS.tolist(),
        "drift": [0.0] * 6,
        "low_pass": None,
        "rotation": THETA,
        "height": 0.0122,
        "mass": 0.0499,
    }
    return ForceTorqueConfig(**(config | changes))


def read(orientations, config, samples=1, generator=None, tool=TOOL):
    """Mean readings at rest of a sensor on the flange at orientations in the base frame."""
    generator = np.random.default_rng(0) if generator is None else generator
    sensor = ForceTorqueSensor(len(orientations) * samples, 0.001, config, generator)
    means = []
    for place, orientation in enumerate(orientations):
        gravity = (orientation @ config.pose[:3, :3]).T @ [0.0, 0.0, -GRAVITY]
        wrench = wrench_transform(config.pose) @ tool.load(gravity, REST)
        means.append(np.mean([sensor.read(place * samples + k, wrench) for k in range(samples)], axis=0))
    return np.array(means)


def noise_free(**changes):
    return mini40(resolution=[0.0] * 6, noise=[0.0] * 6, **changes)


def identify_exact(orientations, readings):
    return identify_gravity(readings, orientations, GRAVITY, NO_NOISE, np.zeros((len(orientations), 3, 3)))


@pytest.fixture(scope="module")
def postures(meca500):
    """Sixteen configurations for weighing a tool well, chosen from a thousand within the arm's limits."""
    lower, upper = np.clip(meca500.position_limits, -np.pi, np.pi)
    candidates = np.random.default_rng(1).uniform(lower, upper, (1000, 6))
    orientations = np.array([meca500.tip_pose(q)[:3, :3] for q in candidates])
    return candidates[choose_orientations(orientations, 16)]


def orientations_at(model, postures):
    return np.array([model.tip_pose(q)[:3, :3] for q in postures])


def test_exact_readings_give_the_truth(meca500, postures):
    orientations = orientations_at(meca500, postures)
    found = identify_exact(orientations, read(orientations, noise_free()))
    np.testing.assert_allclose(found.values, TRUTH, rtol=1e-12)
    np.testing.assert_array_equal(found.covariance, np.zeros((11, 11)))


@given(
    st.floats(0.01, 1.0),
    st.floats(-3.1, 3.1),
    st.lists(st.floats(-0.1, 0.1), min_size=3, max_size=3),
    st.lists(st.floats(-0.5, 0.5), min_size=6, max_size=6),
    st.integers(4, 20),
)
def test_any_tool_angle_and_bias_is_found(mass, theta, centre, bias, count):
    orientations = Rotation.random(count, rng=np.random.default_rng(count)).as_matrix()
    tool = Tool(mass, np.array(centre), np.zeros((3, 3)))
    readings = read(orientations, noise_free(rotation=theta, bias=bias, range=[100.0] * 6), tool=tool)
    found = identify_exact(orientations, readings)
    np.testing.assert_allclose(found.values, [mass, theta, *centre, *bias], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("theta", [0.0, 1.0, 2.0, 3.0, -1.0, -2.0, -3.0])
def test_theta_keeps_its_sign_and_its_half_turn(meca500, postures, theta):
    # The arc cosine of the report would lose the sign, its arc sine the half turn.
    orientations = orientations_at(meca500, postures)
    found = identify_exact(orientations, read(orientations, noise_free(rotation=theta)))
    assert found.theta == pytest.approx(theta, abs=1e-12)


@pytest.mark.parametrize("samples", [1, 20])
def test_errors_are_as_large_as_the_covariance_says(meca500, postures, deviation, samples):
    config, truth = mini40(), orientations_at(meca500, postures)
    errors, covariances = [], []
    for repetition in range(40):
        generator = np.random.default_rng([samples, repetition])
        measured = postures + deviation * generator.standard_normal(postures.shape)
        found = identify_gravity(
            read(truth, config, samples, generator),
            orientations_at(meca500, measured),
            GRAVITY,
            config.reading_variance(samples),
            pose_covariances(meca500, measured, deviation)[:, 3:, 3:],
        )
        errors.append(found.values - TRUTH)
        covariances.append(found.covariance)
    assert consistency(np.array(errors), np.array(covariances), 0.99).holds


def test_errors_of_the_orientations_alone_are_as_large_as_the_covariance_says(meca500, postures):
    # Far beyond the arm's repeatability, as its part in the covariance would else not be seen next to the sensor's.
    deviation, truth = 1e-3, orientations_at(meca500, postures)
    readings = read(truth, noise_free())
    errors, covariances = [], []
    for repetition in range(200):
        measured = postures + deviation * np.random.default_rng(repetition).standard_normal(postures.shape)
        spread = pose_covariances(meca500, measured, deviation)[:, 3:, 3:]
        found = identify_gravity(readings, orientations_at(meca500, measured), GRAVITY, NO_NOISE, spread)
        kept = [0, 1, 5, 6, 7]  # the force step's; the moment step sees no orientation
        errors.append((found.values - TRUTH)[kept])
        covariances.append(found.covariance[np.ix_(kept, kept)])
        np.testing.assert_allclose(found.centre_of_mass, TOOL.centre_of_mass, rtol=1e-9)
    assert consistency(np.array(errors), np.array(covariances), 0.99).holds


def test_covariances_hold_the_truth_as_often_as_they_say(meca500, postures):
    config, orientations = mini40(), orientations_at(meca500, postures)
    held = []
    for repetition in range(200):
        readings = read(orientations, config, generator=np.random.default_rng(repetition))
        spread = np.zeros((len(orientations), 3, 3))
        found = identify_gravity(readings, orientations, GRAVITY, config.reading_variance(1), spread)
        held.append(np.abs(found.values - TRUTH) < ndtri(0.95) * np.sqrt(np.diagonal(found.covariance)))
    shares = np.mean(held, axis=0)
    assert shares.shape == (len(PARAMETERS),)
    np.testing.assert_allclose(shares, 0.9, atol=0.085)  # four standard deviations of 200 draws


def test_averaging_makes_the_estimate_better_by_the_root_of_the_samples(meca500, postures):
    orientations, spread = orientations_at(meca500, postures), np.zeros((16, 3, 3))
    config = mini40()
    one, hundred = (
        np.sqrt(np.diagonal(identify_gravity(
            read(orientations, noise_free()), orientations, GRAVITY, config.reading_variance(n), spread
        ).covariance))
        for n in (1, 100)
    )  # fmt: skip
    np.testing.assert_allclose(one, 10.0 * hundred, rtol=1e-9)


def test_orientations_that_cannot_weigh_are_refused_before_the_readings_are_looked_at():
    turned = np.array([rotation(np.array([0.0, 0.0, angle])) for angle in (0.1, 1.0, 2.0)])
    with pytest.raises(ConfigError, match="condition numbers"):
        identify_exact(turned, np.full((3, 6), np.nan))


def test_readings_without_a_tool_s_weight_are_refused(meca500, postures):
    orientations = orientations_at(meca500, postures)
    upside_down = read(orientations, noise_free(bias=[0.0] * 6)) * -1.0
    with pytest.raises(ConfigError, match=r"a weight of -2\.45 N, turning with the flange as no tool's would"):
        identify_exact(orientations, upside_down)
    with pytest.raises(ConfigError, match="weight of 0 N"):
        identify_exact(orientations, np.zeros((16, 6)))
