"""Every engine that moves an arm under torques, to be asked the same."""

import pytest

from runner.plants import PLANTS
from runner.plants.rk4 import Rk4

ENGINES = {
    "bullet": "plant=bullet",
    "mujoco": "plant=mujoco",
    "mujoco rk4": "plant=mujoco plant.integrator=rk4",
    "rk4": "plant=rk4",
    "compiled rk4": "plant=rk4",
}
"""The overrides that choose each; rk4 goes through Pinocchio here, and is compiled code under the other name."""

ASKED = "plant=bullet"
"""Names the default plant."""

DEFAULT_PLANT = "PyBullet"
"""Name of this plant in reports."""

FOURTH_ORDER = ("mujoco rk4", "rk4", "compiled rk4")
FIRST_ORDER = tuple(name for name in ENGINES if name not in FOURTH_ORDER)

WITHOUT_STOPS = ("rk4", "compiled rk4")
"""Those whose joints pass their limits."""


@pytest.fixture
def engine(checked_config, one_stage):
    """Make plants by the name of their engine, released at the end of the test."""
    plants = []

    def make(name, urdf, model, step, steps_per_tick=1, *overrides):
        config = checked_config("robot=macro", *ENGINES[name].split(), *overrides).plant
        plants.append(PLANTS.build(config, one_stage(urdf, model), step, steps_per_tick))
        if name == "rk4" and isinstance(plants[-1], Rk4):
            plants[-1]._compiled = None
        return plants[-1]

    yield make
    for plant in plants:
        plant.close()
