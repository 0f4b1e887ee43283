"""Orientations that weigh a tool: the matrices against a tool at rest, condition numbers and refusals."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.turns import rotation

from runner.base.errors import ConfigError
from runner.calibration.orientations import (
    MAX_CONDITION_NUMBER,
    check_orientations,
    choose_orientations,
    condition_numbers,
    force_matrix,
    moment_matrix,
)

SIX = np.array([R.as_matrix() for R in Rotation.create_group("O")])  # every face of a cube down, in four ways


def random_orientations(count, seed=0):
    return Rotation.random(count, rng=np.random.default_rng(seed)).as_matrix()


def test_the_matrices_give_the_forces_and_moments_of_a_tool_at_rest():
    theta, G, r = 0.6, 2.3, np.array([0.01, -0.02, 0.04])
    F_0, M_0 = np.array([0.4, -0.2, 1.1]), np.array([0.01, 0.02, -0.03])
    orientations = random_orientations(5)
    mounting = rotation(np.array([0.0, 0.0, theta]))
    forces = np.array([F_0 + (R @ mounting).T @ [0.0, 0.0, -G] for R in orientations])
    moments = M_0 + np.cross(r, forces - F_0)
    unknown = np.concatenate([[G * np.cos(theta), G * np.sin(theta), G], F_0])
    np.testing.assert_allclose(force_matrix(orientations) @ unknown, forces.reshape(-1), atol=1e-14)
    k = M_0 - np.cross(r, F_0)
    np.testing.assert_allclose(moment_matrix(forces) @ np.concatenate([r, k]), moments.reshape(-1), atol=1e-14)


def test_the_condition_numbers_of_an_even_spread():
    # Mean squares of the columns: 2/3, 2/3, 1/3 and 1 of the force matrix; 2/3 and 1 of the moment matrix.
    assert condition_numbers(SIX) == (pytest.approx(np.sqrt(3.0)), pytest.approx(np.sqrt(1.5)))


@pytest.mark.parametrize("count", [6, 8, 16])
def test_chosen_orientations_are_better_than_drawn_ones(count):
    def determinant(orientations):
        rows = np.hstack([np.ones((count, 1)), orientations[:, 2]])
        return np.linalg.det(rows.T @ rows)

    candidates = random_orientations(200)
    chosen = choose_orientations(candidates, count)
    assert len(set(chosen)) == count
    assert max(condition_numbers(candidates[chosen])) < 2.0
    assert determinant(candidates[chosen]) > max(determinant(random_orientations(count, s)) for s in range(1, 101))


def test_the_choice_finds_the_few_good_ones_among_many_alike():
    alike = np.array([rotation(0.05 * np.array([np.cos(a), np.sin(a), 0.1])) for a in np.linspace(0.0, 6.0, 50)])
    candidates = np.concatenate([alike, SIX[:: len(SIX) // 6]])
    chosen = choose_orientations(candidates, 6)
    assert max(condition_numbers(candidates[chosen])) < 5.0
    with pytest.raises(ConfigError, match="condition numbers"):
        check_orientations(alike)


def test_more_than_there_are_cannot_be_chosen():
    with pytest.raises(ConfigError, match="25 wanted of 24 candidates"):
        choose_orientations(SIX, 25)


@pytest.mark.parametrize(
    "axes",
    [
        [(0.0, 0.0, a) for a in (0.1, 1.0, 2.0, 3.0)],  # about the vertical: gravity stays
        [(0.02 * a, 0.01, 0.0) for a in (1.0, 2.0, 3.0, 4.0)],
        [(0.7 * np.cos(a), 0.7 * np.sin(a), 0.0) for a in (1.0, 2.0, 4.0, 5.0)],  # on one cone
        [(0.0, 0.0, 0.1), (0.0, np.pi, 0.0), (0.0, 0.0, 1.0)],  # only up and down
    ],
)
def test_orientations_that_cannot_weigh_a_tool_are_refused(axes):
    with pytest.raises(ConfigError, match=r"condition numbers .* allowed: up to 100\. Gravity turns by"):
        check_orientations(np.array([rotation(np.array(axis)) for axis in axes]))


def test_two_orientations_are_too_few():
    with pytest.raises(ConfigError, match="2; weighing a tool needs 3 or more"):
        check_orientations(SIX[:2])


def test_three_orientations_on_a_great_circle_through_z_suffice():
    orientations = np.array([rotation(np.array([a, 1e-9, 0.0])) for a in (0.0001, 1.5, 3.0)])
    assert max(check_orientations(orientations)) < MAX_CONDITION_NUMBER
