"""Third-party arms under built-in laws: the error relative to the reach, and two plants against each other."""

import numpy as np
import pytest
from support import strangers

CONTROLLERS = ("operational_space", "computed_torque", "differential_inverse_kinematics", "whole_body")
PAIRS = [
    pytest.param(
        controller,
        name,
        marks=[pytest.mark.slow] * ((row + column) % 4 > 0) + [pytest.mark.bullet] * (name == "snake"),
    )
    for row, controller in enumerate(CONTROLLERS)
    for column, name in enumerate(strangers.STRANGERS)
]  # `make test` has one law for each arm, and three arms for each law


@pytest.mark.parametrize(("controller", "name"), PAIRS)
def test_controllers_lead_strangers(simulated_stranger, name, controller):
    trace = simulated_stranger(name, f"controller={controller}")
    assert trace.failure is None
    assert np.abs(trace.error).max() < 1e-3 * strangers.read(name).arm.model.reach


@pytest.fixture(scope="module")
def simulated_stranger():
    from runner.assembly.assemble import assemble
    from runner.simulation.loop import simulate
    from runner.simulation.sensors import make_encoders

    def make(name, *overrides):
        free = ("robot.friction.viscous=0", "robot.friction.coulomb=0")  # no law knows the friction of the files
        config = strangers.config(name, *overrides, *free, "trajectory.duration=1", "duration=0.6")
        loop = assemble(config)
        try:
            return simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0))
        finally:
            loop.plant.close()

    return make


@pytest.mark.parametrize(
    "name", ["mixed", *(pytest.param(name, marks=pytest.mark.slow) for name in ("crane", "planar_two"))]
)  # the most kinds of joints
def test_the_plants_agree_on_strangers(simulated_stranger, name):
    default, rk4 = (simulated_stranger(name, f"plant={plant}") for plant in ("default", "rk4"))
    np.testing.assert_allclose(default.tip, rk4.tip, rtol=0, atol=1e-5 * strangers.read(name).arm.model.reach)
