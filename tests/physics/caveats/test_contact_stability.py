"""Contact behind joint servos: which configs have one, a condition apart from those that have none."""

import numpy as np
import pytest

from runner.caveats.contact_stability import servo_contact

PRESSED = "experiment=meca500/wall", "plant=rk4"
FOLLOWED = "robot=meca500", "controller=differential_inverse_kinematics", "duration=0.1"


def contact(checked_config, *overrides):
    config = checked_config(*overrides)
    return servo_contact(config, config.arm.home)


@pytest.mark.parametrize("plant", ["rk4", "mujoco"])
def test_an_arm_behind_servos_that_force_leads_onto_a_wall_has_one(checked_config, plant):
    config = checked_config("experiment=meca500/wall", f"plant={plant}")
    found = servo_contact(config, config.arm.home)
    assert found.ticks * found.tick == pytest.approx(config.controller.period)
    assert (found.stiffness, found.at_tip) == (config.environment.stiffness, config.controller.wrench_frame == "tip")


@pytest.mark.parametrize(
    "overrides",
    [
        (*PRESSED, "environment=free"),
        ("experiment=meca500/wall", "plant=kinematic"),
        (*FOLLOWED, "environment=wall", "plant=rk4"),
        (*FOLLOWED, "environment=wall", "plant=kinematic"),
        (*FOLLOWED, "plant=rk4"),
        ("robot=meca500", "controller=hybrid_force", "environment=wall", "plant=rk4", "duration=0.1"),
    ],
    ids=[
        "no wall",
        "joints without servos",
        "a law that no force leads",
        "neither servos nor a law that force leads",
        "neither a wall nor a law that force leads",
        "a law of torques",
    ],
)
def test_without_one_of_its_parts_there_is_none(checked_config, overrides):
    assert contact(checked_config, *overrides) is None


@pytest.mark.parametrize("low_pass", [None, 50.0])
def test_the_share_of_the_force_that_a_tick_sees_is_that_of_the_low_pass(checked_config, low_pass):
    found = contact(checked_config, *PRESSED, f"wrist_sensor.low_pass={'null' if low_pass is None else low_pass}")
    expected = 1.0 if low_pass is None else 1.0 - np.exp(-2.0 * np.pi * low_pass * found.tick)
    assert found.seen == pytest.approx(expected, rel=1e-12)
