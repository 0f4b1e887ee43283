"""Compensation of a tool's load: sensor readings of a known tool against the external wrench."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.turns import rotation

from runner.calibration.gravity import REST, GravityCalibration, Motion, Tool, WrenchCompensation, identify_gravity

GRAVITY = 9.81
INERTIA = np.diag([2e-4, 3e-4, 1e-4])
TOOL = Tool(0.25, np.array([0.004, -0.007, 0.031]), INERTIA)
BIAS = np.array([0.8, -1.3, 2.1, 0.012, -0.02, 0.008])
MOUNTING = rotation(np.array([0.0, 0.0, 0.35]))
EXTERNAL = np.array([1.0, -2.0, 3.0, 0.1, 0.2, -0.3])


@pytest.fixture(scope="module")
def compensation():
    calibration = GravityCalibration(
        TOOL.mass, 0.35, TOOL.centre_of_mass, BIAS[:3], BIAS[3:], np.zeros((11, 11)), (1.0, 1.0)
    )
    return WrenchCompensation(calibration, INERTIA, GRAVITY)


def gravity_at(orientation):
    return (orientation @ MOUNTING).T @ [0.0, 0.0, -GRAVITY]


@pytest.mark.parametrize("seed", range(5))
def test_what_is_left_is_the_external_wrench(compensation, seed):
    generator = np.random.default_rng(seed)
    orientation = Rotation.random(rng=generator).as_matrix()
    motion = Motion(*generator.uniform(-3.0, 3.0, (3, 3)))
    reading = BIAS + EXTERNAL + TOOL.load(gravity_at(orientation), motion)
    np.testing.assert_allclose(compensation.external(reading, orientation, motion), EXTERNAL, atol=1e-13)


def test_compensated_for_weight_alone_the_tool_s_inertia_stays(compensation):
    motion = Motion(np.zeros(3), np.zeros(3), np.array([2.0, 0.0, 0.0]))
    orientation = rotation(np.array([0.4, -0.9, 0.2]))
    reading = BIAS + TOOL.load(gravity_at(orientation), motion)
    left = compensation.external(reading, orientation, REST)
    np.testing.assert_allclose(left[:3], [-2.0 * TOOL.mass, 0.0, 0.0], atol=1e-14)


def test_the_weight_is_that_of_the_report(compensation):
    # G_x, G_y and G_z of section 4 with its r_13, r_23, r_33 read as the third row of 0R6.
    orientation = rotation(np.array([0.4, -0.9, 0.2]))
    (x, y, z), G, theta = orientation[2], TOOL.mass * GRAVITY, 0.35
    weight = [
        -G * np.cos(theta) * x - G * np.sin(theta) * y,
        G * np.sin(theta) * x - G * np.cos(theta) * y,
        -G * z,
    ]
    removed = BIAS - compensation.external(np.zeros(6), orientation, REST) - 2.0 * BIAS
    np.testing.assert_allclose(removed[:3], weight, atol=1e-14)


def test_an_identified_tool_leaves_nothing_at_other_orientations():
    known, unknown = np.split(Rotation.random(24, rng=np.random.default_rng(4)).as_matrix(), [8])
    readings = [np.array([BIAS + TOOL.load(gravity_at(R), REST) for R in part]) for part in (known, unknown)]
    calibration = identify_gravity(readings[0], known, GRAVITY, np.zeros(6), np.zeros((8, 3, 3)))
    compensation = WrenchCompensation(calibration, INERTIA, GRAVITY)
    for reading, orientation in zip(readings[1], unknown, strict=True):
        np.testing.assert_allclose(compensation.external(reading, orientation, REST), np.zeros(6), atol=1e-13)
