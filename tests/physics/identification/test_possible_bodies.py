"""Bodies with positive masses and inertias that have some values: found where they exist, missed where they do not."""

import numpy as np
import pytest
from support.identified_logs import KnownArm

from runner.identification.physical import describe_bodies, nearest_bodies


@pytest.fixture(scope="module")
def arm():
    return KnownArm("ur5e")


def misses_of(arm, full):
    factors = np.array([each.factors for each in arm.sums])
    values = factors @ full
    start = np.concatenate([arm.model.inertial_parameters, np.full(6, 0.1)])
    return nearest_bodies(factors, values, 0.01 + 0.05 * np.abs(values), start, 6), [each.name for each in arm.sums]


def test_bodies_are_found_where_they_exist(arm):
    misses, names = misses_of(arm, np.concatenate([arm.links, arm.rotors]))
    assert np.abs(misses).max() < 1.0
    assert describe_bodies(names, misses).startswith("Bodies with positive masses and inertias have these values")


def test_values_of_impossible_bodies_are_missed(arm):
    full = np.concatenate([arm.links, arm.rotors])
    full[[4, 6, 9]] = -5.0  # the first link's inertia
    full[60] = -5.0  # and its rotor's
    misses, names = misses_of(arm, full)
    worst = int(np.argmax(np.abs(misses)))
    assert abs(misses[worst]) > 1.0
    assert names[worst].startswith("I1zz")
    assert "No bodies with positive masses and inertias were found" in describe_bodies(names, misses)
