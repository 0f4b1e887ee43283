"""Options of the laws that follow joints: a short run for each two values of any two options."""

import pytest
from support.covers import covered

from tools.laws import JOINT_LAWS, own_options

OPTIONS = {
    "law": JOINT_LAWS,
    "own": (False, True),
    "task": ("position", "pose"),
    "feedforward": ("true", "false"),
    "gravity_compensation": ("true", "false"),
    "damping_ratio": ("1", "0.8"),
    "singularity_damping": ("0.3", "0.1"),
    "null_space_frequency": ("10", "5"),
}


@pytest.mark.parametrize("chosen", covered(OPTIONS))
def test_every_option_composes_and_runs(simulated, chosen):
    law = chosen["law"]
    keys = [f"{key}={value}" for key, value in chosen.items() if key not in ("law", "own")]
    own = own_options(law) if chosen["own"] else ()
    trace = simulated(
        "robot=xarm7", f"controller={law}", *(f"controller.{key}" for key in (*keys, *own)),
        "robot.armature=assumed", "controller.natural_frequency=10", "controller.period=0.001", "duration=0.1",
    )  # fmt: skip
    assert trace.failure is None
