"""Load of a tool: its wrench against the sum over its mass points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.calibration.gravity import REST, Motion, Tool

GRAVITY = np.array([0.0, 0.0, -9.81])
# Point masses: a tool whose balance is Newton's law for each of them.
MASSES = np.array([0.1, 0.05, 0.08, 0.02])
POINTS = np.array([[0.01, 0.0, 0.02], [0.0, 0.03, 0.05], [-0.02, 0.01, 0.04], [0.0, -0.01, 0.08]])
vectors = st.lists(st.floats(-5.0, 5.0), min_size=3, max_size=3).map(np.array)


@pytest.fixture(scope="module")
def tool():
    centre = MASSES @ POINTS / MASSES.sum()
    arms = POINTS - centre
    inertia = sum(m * (arm @ arm * np.eye(3) - np.outer(arm, arm)) for m, arm in zip(MASSES, arms, strict=True))
    return Tool(float(MASSES.sum()), centre, inertia)


def test_at_rest_it_is_the_weight_at_the_centre_of_mass(tool):
    load = tool.load(GRAVITY, REST)
    np.testing.assert_allclose(load[:3], tool.mass * GRAVITY, atol=1e-15)
    np.testing.assert_allclose(load[3:], np.cross(tool.centre_of_mass, tool.mass * GRAVITY), atol=1e-15)


@given(vectors, vectors, vectors, vectors)
def test_it_is_the_sum_of_its_points_weights_and_inertias(omega, alpha, acceleration, gravity):
    centre = MASSES @ POINTS / MASSES.sum()
    arms = POINTS - centre
    inertia = sum(m * (arm @ arm * np.eye(3) - np.outer(arm, arm)) for m, arm in zip(MASSES, arms, strict=True))
    tool = Tool(float(MASSES.sum()), centre, inertia)
    points = acceleration + np.cross(alpha, POINTS) + np.cross(omega, np.cross(omega, POINTS))
    forces = MASSES[:, None] * (gravity - points)
    expected = np.concatenate([forces.sum(axis=0), np.cross(POINTS, forces).sum(axis=0)])
    load = tool.load(gravity, Motion(omega, alpha, acceleration))
    np.testing.assert_allclose(load, expected, rtol=0, atol=1e-13)


def test_in_free_fall_it_has_no_load(tool):
    np.testing.assert_allclose(tool.load(GRAVITY, Motion(np.zeros(3), np.zeros(3), GRAVITY)), np.zeros(6), atol=1e-15)
