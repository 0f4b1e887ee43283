"""Compiled flexible joints against the plant through Pinocchio."""

import numpy as np
import pytest
from support.arms import model_of

from runner.plants.flexibility import Flexibility
from runner.plants.flexible_joints import FlexibleJoints

SPRINGS = {  # K, B, D; a joint without spring is rigid
    "all": ([1000.0, 800.0, 600.0], [2.0, 1.5, 1.0], [5.0, 4.0, 0.0]),
    "one rigid": ([1000.0, np.inf, 600.0], [2.0, 0.0, 1.0], [5.0, 0.0, 3.0]),
    "braked": ([1000.0, 800.0, 600.0], [2.0, 1.5, 1.0], [5.0, 4.0, 3.0]),
}


@pytest.mark.parametrize("case", SPRINGS)
def test_it_moves_as_by_pinocchio(case):
    model = model_of("macro")
    K, B, D = (np.array(values) for values in SPRINGS[case])
    braked = np.array([0.0, np.inf, 0.012]) if case == "braked" else np.full(3, np.inf)
    plants = [FlexibleJoints(model, Flexibility(K, B, D, braked, np.zeros(3)), 5e-4, 4) for _ in range(2)]
    plants[1]._compiled = None
    assert plants[0]._compiled is not None
    generator = np.random.default_rng(2)
    for plant in plants:
        plant.set_gravity(np.array([0.5, 0.0, -9.0]))
        plant.reset(np.array([0.3, 0.8, -0.5]), np.array([0.2, -0.4, 0.6]))
    for _ in range(200):
        tau, load = generator.normal(0.0, 20.0, (2, 3))
        for plant in plants:
            plant.load[:] = load
            plant.advance(tau)
    for name in ("q", "dq", "theta", "dtheta"):
        np.testing.assert_allclose(getattr(plants[0], name), getattr(plants[1], name), rtol=1e-11, atol=1e-12)
    assert np.abs(plants[0].dq).max() > 0.1
