"""Runge-Kutta plant: fourth order against an adaptive integrator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.arms import model_of, urdf_of
from support.physics import assert_order

from runner.plants import PLANTS
from runner.plants.rk4 import Rk4, build
from runner.robots.model import RobotModel

ARMS = [("macro", 1.0), ("mini", 0.1)]  # name, and by what all lengths, masses and times are scaled
START = np.array([0.3, 0.5, -0.4]), np.array([1.0, 0.5, -0.5])
TORQUES = np.array([[5.0, -3.0, 2.0], [-8.0, 10.0, -4.0], [2.0, 15.0, -9.0], [0.0, 4.0, 1.0]])
TICK = 0.1


def make(name, step, steps_per_tick):
    urdf = urdf_of(name)
    return Rk4(RobotModel(urdf, "tip"), step, steps_per_tick)


def final_state(name, scale, steps):
    """State after four ticks of held torques, velocities in units of the macro's."""
    plant = make(name, TICK * scale / steps, steps)
    plant.reset(START[0], START[1] / scale)
    for tau in TORQUES * scale:
        plant.advance(tau)
    return np.concatenate([plant.q, plant.dq * scale])


def reference_state(name, scale):
    model = model_of(name)
    state = np.concatenate([START[0], START[1] / scale])
    for tau in TORQUES * scale:

        def slope(t, y, tau=tau):
            return np.concatenate([y[3:], model.forward_dynamics(y[:3], y[3:], tau)])

        state = solve_ivp(slope, (0.0, TICK * scale), state, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    return np.concatenate([state[:3], state[3:] * scale])


@pytest.mark.parametrize(("name", "scale"), ARMS)
def test_fourth_order_convergence_under_held_torques(name, scale):
    reference = reference_state(name, scale)
    errors = [np.linalg.norm(final_state(name, scale, steps) - reference) for steps in (10, 20, 40, 80)]
    assert_order(errors, 4, within=0.25)


@pytest.mark.parametrize(("name", "scale"), ARMS)
def test_agrees_with_an_adaptive_integrator(name, scale):
    np.testing.assert_allclose(final_state(name, scale, 400), reference_state(name, scale), atol=2e-10)


def test_reset_copies_its_arguments():
    plant = make("macro", 1e-2, 1)
    q, dq = START[0].copy(), START[1].copy()
    plant.reset(q, dq)
    plant.advance(TORQUES[0])
    np.testing.assert_array_equal(q, START[0])
    np.testing.assert_array_equal(dq, START[1])


@pytest.mark.parametrize("dynamics", ["coupled", "decoupled"])
@pytest.mark.parametrize("wrist_rotation", ["real", "parallel"])
def test_build_and_default_step(checked_config, macro_urdf, one_stage, dynamics, wrist_rotation):
    # One stage has nothing to couple: neither key has an effect.
    config = checked_config(
        "robot=macro", "plant=rk4", f"plant.dynamics={dynamics}", f"plant.wrist_rotation={wrist_rotation}"
    ).plant
    plant = build(config, one_stage(macro_urdf, RobotModel(macro_urdf, "tip")), 0.01, 1)
    assert isinstance(plant, Rk4)
    plant.close()
    assert [PLANTS.features("rk4").default_step(0.01, stages) for stages in (1, 2)] == [0.01, 0.01]
