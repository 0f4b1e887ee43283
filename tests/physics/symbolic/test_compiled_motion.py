"""Compiled Runge-Kutta step against Pinocchio's articulated bodies."""

import numpy as np
import pytest
from support import strangers
from support.arms import checked

from runner.plants import compiled_motion
from runner.plants.rk4 import Rk4


@pytest.mark.parametrize("name", ["macro", "mini", "combined", "xarm7", "meca500", "franka", "crane", "mixed"])
def test_whole_motions_are_those_of_pinocchio(name, monkeypatch):
    ours = name not in strangers.STRANGERS
    arm = checked(f"robot={name}").arm if ours else strangers.config(name).arm
    plant = Rk4(arm.model, 1e-3, 2)
    monkeypatch.setattr(compiled_motion, "evaluator", dict)
    reference = Rk4(arm.model, 1e-3, 2)
    assert (plant._compiled is None, reference._compiled is None) == (False, True)
    generator, scale = np.random.default_rng(2), np.diagonal(arm.model.mass_matrix(arm.home))
    for moved in (plant, reference):
        moved.set_gravity(np.array([1.0, 2.0, -9.0]))
        moved.reset(arm.home, np.zeros(arm.model.nq))
    for _ in range(100):
        tau = arm.model.gravity_torque(reference.q) + scale * generator.normal(size=arm.model.nq)
        for moved in (plant, reference):
            moved.advance(tau)
    assert np.abs(reference.q - arm.home).max() > 1e-2
    np.testing.assert_allclose(plant.q, reference.q, rtol=0.0, atol=1e-11)


def test_a_model_that_changes_later_is_not_seen():
    model = checked("robot=macro").arm.model.copy()
    first, second = Rk4(model, 0.01, 1), Rk4(model.copy(), 0.01, 1)
    model.pin_model.gravity.linear = np.zeros(3)
    for moved in (first, second):
        moved.advance(np.ones(3))
    np.testing.assert_array_equal(first.q, second.q)
