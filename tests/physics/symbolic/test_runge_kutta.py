"""Friction and Runge-Kutta steps as programs against the same text on floats, to the bit."""

import numpy as np
import pytest
from support.friction import friction_law, law_of_tick
from support.programs import computed

from runner.plants.friction import pivot
from runner.plants.runge_kutta import advance_stage, runge_kutta
from runner.symbolic.backend import SymbolicBackend
from runner.symbolic.expression import equal, select
from runner.symbolic.maths import NUMPY
from runner.symbolic.program import STAGES
from runner.symbolic.vectors import as_array

DRY = {"viscous": [0.3, 0.0, 1.0], "coulomb": [1.0, 0.0, 2.5], "static": [1.7, 0.4, 2.5], "asymmetry": [0.1, 0.0, -2.0]}
FALLING = {**DRY, "stribeck_speed": {"q1": 0.05, "q3": 0.2}}
SIGMOID = {"level": [1.0, 0.0, 0.7], "steepness": [8.0, 0.0, 12.0], "shift": [0.03, 0.0, -0.01]}


@pytest.mark.parametrize(
    ("friction", "places"),
    [
        ({"viscous": [0.3, 0.0, 1.0]}, 0),
        (DRY, 0),
        (FALLING, 3),
        ({**FALLING, "stribeck_curve": "exponential"}, 3),
        ({**DRY, **SIGMOID}, 4),
    ],
    ids=["viscous", "dry", "gauss", "exponential", "sigmoid"],
)
def test_a_program_takes_the_law_for_a_tick_from_the_same_text(friction, places):
    """To the bit; where exponentials differ, which are the platform's on floats, to their last places."""
    law, generator = friction_law(3, **friction), np.random.default_rng(0)
    given = np.concatenate([generator.normal(0.0, 0.2, (300, 3)), generator.integers(0, 2, (300, 3))], axis=1)
    given[:3, :3] = 0.0

    def express(rows):
        held = [equal(value, 1.0) for value in rows[3:]]
        damping, level = law.at(SymbolicBackend(), rows[:3], held)
        return [*damping, *level]

    found = computed(f"law {friction}", express, given)
    theirs = np.array([np.concatenate(law_of_tick(law, row[:3], row[3:] == 1.0)) for row in given])
    assert np.abs((found - theirs) / np.spacing(theirs)).max() <= places


def test_a_program_judges_directions_by_the_same_text():
    """To the bit where no joint is held; the floats' factorisation is another one than the program's."""
    generator = np.random.default_rng(0)
    A, limit = np.array([[2.0, -0.5, 0.25], [-0.5, 1.0, 0.0], [0.25, 0.0, 4.0]]), np.array([0.5, 1.0, 0.0])
    given = np.concatenate([generator.normal(size=(300, 3)), generator.integers(-1, 2, (300, 3))], axis=1)

    def express(rows):
        found, sides, agrees = pivot(SymbolicBackend(), A, as_array(rows[:3]), limit, as_array(rows[3:]))
        return [*found, *sides, select(agrees, 1.0, 0.0)]

    found = computed("pivot", express, given)
    for row, (speed, direction) in zip(found, zip(given[:, :3], given[:, 3:], strict=True), strict=True):
        mu, sides, agrees = pivot(NUMPY, A, speed, limit, direction)
        np.testing.assert_allclose(row[:3], mu, rtol=1e-14 if (direction == 0.0).any() else 0.0)
        np.testing.assert_array_equal(row[3:6], sides)
        assert row[6] == float(agrees)
    assert 5 < found[:, 6].sum() < 290


def test_a_program_of_a_runge_kutta_step_has_the_bits_of_the_step_on_floats():
    def slope(x):
        return np.concatenate([x[2:], [x[1] * x[2] - 3.0 * x[0], x[0] - x[3] * x[3]]])

    given = np.random.default_rng(0).normal(size=(100, 4))

    def express(x):
        x, h = as_array(x), 0.01
        at, sums = x, [0.0 * x]
        for row in STAGES[:, [0, 2]].tolist():
            at, sums = advance_stage(slope, x, h, row, at, sums)
        return list(x + (h / 6.0) * sums[0])

    found = computed("step", express, given)
    np.testing.assert_array_equal(found, [runge_kutta(slope, row, 0.01, 1) for row in given])
