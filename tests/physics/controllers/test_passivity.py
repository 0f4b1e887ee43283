"""Passivity-based control of the joints: its equation, the energy that it takes, and whole runs."""

import numpy as np
import pinocchio as pin
import pytest

from runner.assembly.validation import validate
from runner.config.compose.compose import compose

CONFIGS = {
    name: validate(
        compose([f"robot={name}", "controller=passivity", "trajectory=joint_quintic", "robot.natural_frequency=30"])
    )
    for name in ("macro", "xarm7")
}


def drawn(name):
    """Return a law, its model, and a state with a reference."""
    config = CONFIGS[name]
    model, generator = config.arm.model, np.random.default_rng(5)
    n = model.nq
    q, dq, reference = (
        config.arm.home + generator.normal(size=n),
        generator.normal(size=n),
        generator.normal(size=(3, n)),
    )
    return config.loops[0].controller, config.arm, q, dq, reference


@pytest.mark.parametrize("name", ["macro", "xarm7"])
def test_torques_are_those_of_the_equation_with_the_coriolis_matrix(name):
    law, arm, q, dq, reference = drawn(name)
    D = arm.model.mass_matrix(arm.home).diagonal()
    dq_r = reference[1] + 30.0 * (reference[0] - q)
    ddq_r = reference[2] + 30.0 * (reference[1] - dq)
    pin_model = arm.model.pin_model
    C = pin.computeCoriolisMatrix(pin_model, pin_model.createData(), q, dq)
    expected = arm.model.mass_matrix(q) @ ddq_r + C @ dq_r + arm.model.gravity_torque(q) + 30.0 * D * (dq_r - dq)
    np.testing.assert_allclose(
        law.torque(0.0, q, dq, reference), expected, rtol=0.0, atol=1e-9 * np.abs(expected).max()
    )


@pytest.mark.parametrize("name", ["macro", "xarm7"])
def test_the_energy_of_s_falls_by_its_damping(name):
    """d/dt (s^T M s / 2) = -s^T K_D s, the left side by differences along the true motion."""
    law, arm, q, dq, reference = drawn(name)
    torque, pin_model = law.torque(0.0, q, dq, reference), arm.model.pin_model
    ddq = pin.aba(pin_model, pin_model.createData(), q, dq, torque)
    dq_r = reference[1] + 30.0 * (reference[0] - q)
    s, ds = dq_r - dq, reference[2] + 30.0 * (reference[1] - dq) - ddq

    def energy(t):
        moved = s + t * ds
        return 0.5 * moved @ arm.model.mass_matrix(q + t * dq) @ moved

    h = 1e-6
    falls = -30.0 * s @ (arm.model.mass_matrix(arm.home).diagonal() * s)
    np.testing.assert_allclose((energy(h) - energy(-h)) / (2.0 * h), falls, rtol=1e-6)


def test_the_tip_reaches_a_goal(simulated):
    trace = simulated("robot=macro", "controller=passivity", "controller.period=0.001",
                      "controller.natural_frequency=10", "trajectory=goal", "duration=3")  # fmt: skip
    assert trace.failure is None
    np.testing.assert_allclose(trace.error[-1], 0.0, atol=1e-6)
