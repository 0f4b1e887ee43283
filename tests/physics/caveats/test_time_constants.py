"""Time constants of the parts of laws, against how errors fade in runs, and against closed forms."""

import math
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from scipy.linalg import expm

from runner.caveats.time_constants import slowest_part
from runner.controllers import CONTROLLERS
from runner.controllers.joint_space.computed_torque import ComputedTorqueConfig
from runner.controllers.torque_law import PinocchioArm

REST = ("robot=macro", "trajectory=joint_quintic", "trajectory.goal_configuration=${robot.home}",
        "plant=rk4", "controller.period=0.001", "plant.step=0.001")  # fmt: skip
SLOW = [
    ("integral", 0.1745, "controller=computed_torque", "controller.integral_gain=3375"),
    ("integral", 0.5939, "controller=joint_pid", "controller.integral_share=0.05"),
    ("disturbance observer", 0.25, "controller=computed_torque", "disturbance_observer=momentum",
     "disturbance_observer.bandwidth=4"),
]  # fmt: skip


@pytest.mark.parametrize(("part", "seconds", "law"), [(part, seconds, law) for part, seconds, *law in SLOW])
def test_what_a_wrong_gravity_leaves_at_rest_fades_by_e_in_each(checked_config, simulated, part, seconds, law):
    found = slowest_part(checked_config(*REST, *law))
    assert found == (pytest.approx(seconds, rel=1e-3), part)
    q = simulated(*REST, *law, "mismatch.gravity=0.9", "duration=1.5").q
    error = np.linalg.norm(q - q[0], axis=1)
    later = error[800 + round(1000 * found.seconds)] / error[800]
    assert later == pytest.approx(math.exp(-1.0), rel=0.01)


def test_the_rates_of_adaptation_are_those_at_which_errors_fade_at_rest(checked_config, simulated):
    """Only gravity excites: K_D ds/dt = -Y Gamma Y^T s, in which errors of the model's masses cancel."""
    law = ("controller=adaptive", "controller.adaptation_gain=0.02", "controller.friction=false")
    config = checked_config(*REST, *law)
    own = config.loops[0].controller
    Y = PinocchioArm(own.models[0], True).regressor(config.arm.home, *np.zeros((3, 3)))
    A = (Y * own.parameters.own.adaptation_gain) @ Y.T / own.parameters.own.damping[:, None]
    q = simulated(*REST, *law, "mismatch.mass=0.9", "duration=13").q
    later, before = q[[13000, 1000]] - q[0]
    np.testing.assert_allclose(later, expm(-12.0 * A) @ before, rtol=0.0, atol=0.01 * np.linalg.norm(later))
    rates = np.linalg.eigvals(A).real
    left = rates @ np.exp(-2.0 * rates * slowest_part(config).seconds) / rates.sum()
    assert left == pytest.approx(math.exp(-2.0), rel=1e-6)


ROUND = ("robot=macro", "trajectory=circle", "trajectory.easing=none", "trajectory.duration=2", "duration=7.4",
         "mismatch.mass=0.8")  # fmt: skip


def test_along_a_path_an_adaptation_has_done_two_thirds_of_its_work_after_one(checked_config, simulated):
    adaptive = (*ROUND, "controller=adaptive", "controller.adaptation_gain=0.1")
    found = slowest_part(checked_config(*adaptive))
    assert found == (pytest.approx(6.4, abs=0.1), "adaptation")
    adapted, never = (simulated(*overrides) for overrides in (adaptive, (*ROUND, "controller=passivity")))
    ticks = round(2.0 / checked_config(*adaptive).timing.tick)  # of a round, about the time constant
    errors = [np.sqrt(((run.tip - run.desired[:, 0])[-ticks:] ** 2).sum(axis=1).mean()) for run in (adapted, never)]
    assert errors[0] / errors[1] == pytest.approx(math.exp(-1.0), abs=0.12)


HAND = ("robot=meca500", "controller=admittance")
WALL = ("robot=macro", "controller=hybrid_force", "controller.wall_stiffness=1e8", "controller.integral_gain=0.5")
CLOSED = [
    (("robot=macro", "controller=passivity"), 1.0 / 30.0, "position loop"),
    (("robot=macro", "controller=passivity", "controller.damping_ratio=0.5"), 2.0 / 30.0, "position loop"),
    ((*REST, "controller=passivity", "controller.damping_ratio=0.5"), 1.0 / 30.0, "position loop"),
    (("robot=macro", "controller=operational_space", "controller.damping_ratio=2"),
     1.0 / (30.0 * (2.0 - math.sqrt(3.0))), "position loop"),
    (("robot=combined", "controller.natural_frequency.mini=5"), 0.2, "position loop"),
    (("robot=combined", "controller=whole_body"), 1.0 / 30.0, "position loop"),
    (("robot=xarm7", "controller=differential_inverse_kinematics", "controller.gain=4"), 0.25, "position loop"),
    ((*ROUND, "controller=iterative_learning"), 2.0, "learning"),
    ((*ROUND, "controller=iterative_learning", "controller.learning_gain=0.3"), -2.0 / math.log(0.7), "learning"),
    (HAND, 0.05, "admittance"),
    ((*HAND, "controller.stiffness=[0,0,0,0,0,0]"), 0.025, "admittance"),  # M / B: it has nowhere to go back to
    (WALL, 4.0, "force integral"),  # (1 + k_f) / k_i on a wall that is hard
]  # fmt: skip


@pytest.mark.parametrize(("overrides", "seconds", "part"), CLOSED)
def test_others_have_closed_forms(checked_config, overrides, seconds, part):
    assert slowest_part(checked_config(*overrides)) == (pytest.approx(seconds, rel=1e-3), part)


def test_what_never_fades_has_none(checked_config):
    undamped = (*HAND, "controller.damping=[0,0,0,0,0,0]", "controller.check_stability=false")
    assert slowest_part(checked_config(*undamped)).seconds == 0.0
    assert slowest_part(checked_config("robot=macro", "controller=impedance")) is None


class Derived(ComputedTorqueConfig):
    """Config of another law, derived from that of a law whose time constants are known."""


@pytest.mark.parametrize("model", [ComputedTorqueConfig, Derived])
def test_another_law_with_such_a_config_has_that_of_its_observer_alone(checked_config, monkeypatch, model):
    config = checked_config(*REST, *SLOW[2][2:])
    other = ModuleType(Derived.__module__)  # a module that uses the config of another, and one with its own
    monkeypatch.setattr(CONTROLLERS, "module", lambda kind: other)
    config = replace(config, controller=model(**config.controller.model_dump()))
    assert slowest_part(config) == (0.25, "disturbance observer")
    unseen = config.disturbance_observer.model_copy(update={"bandwidth": None})
    assert slowest_part(replace(config, disturbance_observer=unseen)) is None
