"""Linear map of contact behind joint servos: limits, and runs on both sides of its bound."""

from dataclasses import replace

import numpy as np
import pytest
from support.arms import checked

from runner.assembly.assemble import assemble
from runner.assembly.validation import validate
from runner.caveats.contact_stability import servo_contact
from runner.caveats.monitor import Watch
from runner.caveats.servo_contact_stability import contact_map, contact_radius, stiffest_servo_wall
from runner.caveats.setting import setting_of
from runner.config.compose.compose import compose
from runner.controllers.force.admittance_filter import Admittance, discretise
from runner.controllers.stability import wall_radius
from runner.plants.servo import ServoLaw
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders, make_wrist_sensor

pytestmark = pytest.mark.bullet  # servos against a wall
PRESSED = (
    "experiment=meca500/wall", "environment.distance=0", "environment.damping=0", "trajectory.goal=[0.185,0.01,0.06]",
    "controller.period=0.01", "plant=default", "plant.servo.period=0.001", "plant.step=0.001",
    "plant.servo.stiffness=15000", "controller.damping=[80,80,80,0.8,0.8,0.8]",
)  # fmt: skip


def made(*overrides):
    config = checked(*PRESSED, *overrides)
    closed = assemble(config)
    return config, closed


def contact_of(*overrides):
    config, closed = made(*overrides)
    closed.close()
    return servo_contact(config, closed.q_start)


@pytest.fixture(scope="module")
def contact():
    return contact_of()


def ideal(contact, stiffness, period=0.01):
    return max(wall_radius(contact.law, period, axis, stiffness if axis == 0 else 0.0, 0.0, 0) for axis in range(6))


@pytest.mark.parametrize("stiffness", [1e2, 5e3, 2e4, 4e4])
def test_stiff_servos_at_short_steps_are_ideal_joints(contact, stiffness):
    def off(spring, tick):
        config = checked(*PRESSED).plant.servo
        law = ServoLaw(
            contact.arm.model, config.model_copy(update={"stiffness": spring, "period": tick}), contact.arm.home
        )
        stiff = replace(
            contact, servo=law, step=tick, tick=tick, ticks=round(0.01 / tick), stiffness=stiffness, inertia=False
        )
        return abs(contact_radius(stiff) - ideal(contact, stiffness))

    assert off(1e6, 1e-4) < 4e-3
    assert off(1e7, 2e-5) < 0.3 * off(1e6, 1e-4) + 1e-9


def test_without_a_wall_the_free_law_is_left():
    contact = contact_of("robot.tool.mass=1e-9", "robot.tool.inertia=[1e-12,1e-12,1e-12]")  # it would be felt
    gentle = Admittance(contact.law.mass, 0.2 * contact.law.damping, contact.law.stiffness)
    free = max(np.abs(np.linalg.eigvals(Phi)).max() for Phi in discretise(gentle, 0.01)[0])
    still = replace(contact, stiffness=1e-9, law=gentle, inertia=False)
    assert contact_radius(still) == pytest.approx(free, abs=1e-6)
    guided = replace(contact, stiffness=1e-9, law=Admittance(gentle.mass, gentle.damping, np.zeros(6)))
    assert contact_radius(guided) == pytest.approx(1.0, abs=1e-9)


def test_more_steps_in_a_tick_change_little_and_a_late_command_much(contact):
    fine = replace(contact, step=contact.step / 10.0, steps=10)
    assert contact_radius(fine) == pytest.approx(contact_radius(contact), rel=0.02)
    hard = replace(contact, stiffness=2e4)
    assert contact_radius(replace(hard, delay=10)) > 1.05 > contact_radius(hard)
    assert contact_map(replace(contact, delay=13)).shape == (60, 60)


def test_at_the_bound_the_radius_is_one_and_soft_servos_have_none(contact):
    bound = stiffest_servo_wall(contact)
    assert contact_radius(replace(contact, stiffness=bound)) == pytest.approx(1.0, abs=1e-4)
    assert stiffest_servo_wall(contact_of("plant.servo.stiffness=1500")) is None


def swings(plant, share, bound):
    """Force of the wall over a run, in the last third and the one before, with torques as large as asked for."""
    config, closed = made(f"plant={plant}", f"environment.stiffness={share * bound:.6g}", "duration=0.9")
    closed.plant._limits.max[:] = np.inf
    wrist = make_wrist_sensor(closed, config.wrist_sensor, 0, 0)
    trace = simulate(closed, make_encoders(closed, config.noise, 0, 0), wrist)
    closed.close()
    force = -trace.contact.external[:, 0]
    third = len(force) // 3
    return force[-third:], np.ptp(force[third : 2 * third])


@pytest.mark.parametrize("plant", ["bullet", "mujoco", "rk4"])
def test_runs_bounce_beyond_the_bound_alone(plant):
    bound = stiffest_servo_wall(contact_of(f"plant={plant}"))
    last, before = swings(plant, 0.9, bound)
    assert last.min() > 0.0
    assert np.ptp(last) < before
    last, _ = swings(plant, 1.1, bound)
    assert last.min() <= 0.0


@pytest.mark.parametrize(
    "overrides",
    [("plant=kinematic",), ("environment=free",), ("controller.compensation=gravity", "environment=push")],
)
def test_without_servos_or_a_wall_there_is_none(overrides):
    config = validate(
        compose(("robot=meca500", *(("environment=wall",) if overrides[0] == "plant=kinematic" else ()), *overrides))
    )
    assert servo_contact(config, config.arm.home) is None


def test_a_singular_posture_cannot_be_told(contact):
    with pytest.raises(np.linalg.LinAlgError):
        contact_radius(replace(contact, q=np.zeros(6)))


def told(stiffness, *overrides):
    config, closed = made(f"environment.stiffness={stiffness}", *overrides)
    closed.close()
    found = Watch(setting_of(config, closed.q_start), config.caveats).found()
    return {caveat.rule: caveat for caveat in found.caveats}


def test_a_wall_too_stiff_behind_servos_is_told():
    caveat = told(4e4)["unstable_contact"]
    assert caveat.value > 1.0
    assert f"grows {caveat.value:.4g} times in each controller.period" in caveat.text
    assert "unstable_contact" not in told(4e4, "caveats.unstable_contact.radius=2")
    assert "unstable_contact" not in told(1e4)
    guided_by_hand = "controller.stiffness=[800,0,0,8,8,8]"
    assert "unstable_contact" not in told(1e4, guided_by_hand)  # an axis that is is not unstable
