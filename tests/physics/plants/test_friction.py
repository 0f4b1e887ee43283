"""Friction in the joints: what stops, what holds, what it takes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.engines import ENGINES
from support.friction import MASS as M
from support.friction import WHEEL, friction_law
from support.physics import assert_order, assert_passive

from runner.plants.friction import Frictional, stopping_torques, with_friction
from runner.plants.rk4 import Rk4
from runner.robots.model import RobotModel


@pytest.fixture(params=ENGINES)
def turn(request, engine):
    """Turn the wheel about the vertical, in every engine."""

    def turn(speed=0.0, torque=0.0, tick=1e-3, ticks=1000, **friction):
        """Return its speeds, the first included, and where it ends."""
        model = RobotModel(WHEEL, "wheel")
        inner = engine(request.param, WHEEL, model, tick)
        plant = Frictional(inner, model, friction_law(**friction), tick)
        plant.reset(np.zeros(1), np.array([speed]))
        speeds = [speed]
        for _ in range(ticks):
            plant.advance(np.array([torque]))
            speeds.append(float(plant.dq[0]))
        return np.array(speeds), float(plant.q[0])

    return turn


def test_viscous_friction_lets_speed_decay_exponentially_first_order_in_the_tick(turn):
    def error(tick):
        ticks = round(0.4 / tick)
        speeds, _ = turn(viscous=0.9, speed=2.0, tick=tick, ticks=ticks)
        return np.abs(speeds - 2.0 * np.exp(-0.9 * tick * np.arange(ticks + 1) / M)).max()

    errors = [error(2e-3), error(1e-3)]
    assert errors[1] < 0.8e-3
    assert_order(errors, 1, within=0.014)


def test_a_sliding_joint_stops_after_its_momentum_over_the_dry_friction_and_stays(turn):
    speeds, way = turn(coulomb=1.5, speed=1.0, ticks=500)
    stop = 1.0 * M / 1.5  # s
    assert np.flatnonzero(np.abs(speeds) < 1e-12)[0] == pytest.approx(stop / 1e-3, abs=1.0)
    np.testing.assert_allclose(speeds[:450], np.maximum(1.0 - 1.5 / M * np.arange(450) * 1e-3, 0.0), atol=1.5e-3 / M)
    assert np.abs(speeds[460:]).max() < 1e-12
    assert way == pytest.approx(0.5 * 1.0 * stop, abs=1.0 * 1e-3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_joint_holds_below_the_dry_friction_and_slips_by_what_is_beyond(turn, sign):
    speeds, way = turn(coulomb=1.5, torque=sign * 1.499, ticks=100)
    assert np.abs(speeds).max() < 1e-12
    assert abs(way) < 1e-12
    speeds, _ = turn(coulomb=1.5, torque=sign * 1.6, ticks=100)
    assert speeds[-1] == pytest.approx(sign * 0.1 * 0.1 / M, rel=1e-6)  # 0.1 N m for 0.1 s


@pytest.mark.parametrize("friction", [{"viscous": 1e7}, {"coulomb": 1e7}, {"viscous": 1e4, "coulomb": 1e4}])
def test_no_friction_is_so_large_that_it_turns_the_motion_round(turn, friction):
    speeds, _ = turn(**friction, speed=5.0, ticks=50)
    assert speeds.min() > -1e-12
    assert (np.diff(speeds) < 1e-12).all()
    assert speeds[-1] < 1e-3


@pytest.fixture
def sliding(macro):
    """Make the Macro with friction in its joints, in motion."""

    def make(viscous, coulomb, tick=1e-3, speed=(2.0, -1.0, 1.5)):
        plant = with_friction(Rk4(macro, tick, 1), macro, friction_law(3, viscous=viscous, coulomb=coulomb), tick)
        plant.reset(np.array([0.3, 0.4, -0.9]), np.array(speed))
        return plant

    return make


def test_without_friction_the_plant_is_left_as_it_is(macro):
    plant = Rk4(macro, 1e-3, 1)
    assert with_friction(plant, macro, friction_law(3), 1e-3) is plant


@pytest.mark.parametrize(("viscous", "coulomb"), [(3.0, 0.0), (0.0, 4.0), (2.0, 2.0)])
def test_friction_only_takes_energy(sliding, macro, viscous, coulomb):
    plant = sliding(viscous, coulomb)
    plant.set_gravity(np.zeros(3))

    def energy():
        return 0.5 * plant.dq @ macro.mass_matrix(plant.q) @ plant.dq

    energies = [energy()]
    for _ in range(2000):
        plant.advance(np.zeros(3))
        energies.append(energy())
    assert_passive(energies, rounding=1e-12)
    assert energies[-1] < 0.1 * energies[0]


def test_an_arm_held_by_dry_friction_does_not_sag_and_one_beyond_it_slides(sliding, macro):
    held = sliding(0.0, 25.0, speed=np.zeros(3))
    start = held.q.copy()
    G = macro.gravity_torque(start)
    assert 20.0 < np.abs(G).max() < 25.0
    for _ in range(1000):
        held.advance(np.zeros(3))
    np.testing.assert_allclose(held.q, start, atol=1e-12)
    sliding_down = sliding(0.0, 20.0, speed=np.zeros(3))
    sliding_down.advance(np.zeros(3))
    assert np.abs(sliding_down.dq).max() > 1e-4


def test_an_arm_with_friction_converges_to_first_order_in_the_tick(sliding):
    def end(tick):
        plant = sliding(1.0, 3.0, tick)
        for k in range(round(0.2 / tick)):
            plant.advance(np.array([20.0, 30.0, 10.0]) * np.cos(5.0 * k * tick))
        return np.concatenate([plant.q, plant.dq])

    finest = end(1.25e-4)
    coarse, fine = (np.abs(end(tick) - finest).max() for tick in (2e-3, 1e-3))
    assert coarse / fine == pytest.approx((2e-3 - 1.25e-4) / (1e-3 - 1.25e-4), rel=0.1)


@given(st.integers(1, 10), st.integers(0, 2**32 - 1))
def test_what_stops_the_joints_meets_the_conditions_of_dry_friction(joints, seed):
    draw = np.random.default_rng(seed)
    half = draw.normal(size=(joints, joints))
    mobility = half @ half.T + 1e-3 * np.eye(joints)
    speed, limit = draw.normal(size=joints), draw.exponential(0.5, joints) * draw.integers(0, 2, joints)
    mu, direction = stopping_torques(mobility, speed, limit, draw.integers(-1, 2, joints).astype(float))
    left = speed - mobility @ mu
    assert (np.abs(mu) <= limit).all()
    scale = 1e-7 * np.abs(speed).max()
    assert np.abs(left[direction == 0.0]).max(initial=0.0) < scale
    slipping = np.abs(left) > scale
    np.testing.assert_allclose(mu[slipping], (limit * np.sign(left))[slipping], atol=1e-12)


@pytest.mark.parametrize("plant", ["bullet", "mujoco"])
def test_friction_of_a_contact_that_the_plant_makes(closed_loop, plant):
    """A tool pressed into an engine's wall, let go: dry friction holds it there; without it the wall throws it."""

    def moved(coulomb):
        closed = closed_loop(
            "robot=meca500",
            "controller=operational_space",
            f"plant={plant}",
            "environment=wall",
            "environment.distance=-0.001",
            "environment.stiffness=3000",
            f"plant.friction.coulomb={coulomb}",
        )
        pressed, model, start = closed.plant, closed.robot.model, closed.q_start
        pressed.reset(start, np.zeros(6))
        for _ in range(500):
            pressed.advance(model.gravity_torque(start))
        return np.abs(pressed.q - start).max()

    assert moved(0.0) > 1e-2
    assert moved(5.0) < 2e-4  # in the first tick, before there is a contact to hold against


def test_servos_against_dry_friction_stop_short_by_no_more_than_the_friction_holds(simulated, checked_config):
    """K (q_c - q) = (1 + A M^-1) mu, A = h D + h^2 K: the servo relies on its predicted motion."""
    case = ("robot=xarm7", "plant=rk4", "plant.friction.coulomb=2", "trajectory=quintic", "trajectory.duration=1")
    trace = simulated(*case, "duration=3", "controller.feedback=commanded", "controller.null_space.task=none")
    arm = checked_config(*case).arm
    M = arm.model.mass_matrix(trace.q[-1])
    A = np.diag(1e-3 * 2.0 * np.sqrt(1500.0 * np.diagonal(arm.model.mass_matrix(arm.home))) + 1e-6 * 1500.0)
    mu = np.linalg.solve(np.eye(7) + A @ np.linalg.inv(M), 1500.0 * (trace.q_command - trace.q)[-1])
    assert np.abs(trace.dq[-1]).max() < 1e-9
    assert 0.5 < np.abs(mu).max() <= 2.0 + 1e-9


@pytest.mark.parametrize("dynamics", ["coupled", "decoupled"])
def test_each_joint_of_a_staged_robot_has_its_own_friction(simulated, dynamics):
    trace = simulated(
        "robot=combined",
        f"plant.dynamics={dynamics}",
        "plant=rk4",
        "plant.friction.coulomb=[0,0,0,1e3,1e3,1e3]",
        "trajectory=quintic",
        "duration=0.5",
    )
    assert np.abs(trace.q[:, 3:]).max() < 1e-6  # what the base stage's speeds change within a tick
    assert np.ptp(trace.q[:, :3], axis=0).max() > 1e-3


@pytest.mark.parametrize(
    ("override", "message"),
    [
        (
            "plant.friction.viscous=[1,2]",
            "plant.friction.viscous: 2 values for 3 joints (q1, q2, q3); found [1.0, 2.0]",
        ),
        ("plant.friction.coulomb=-1", "plant.friction.coulomb: must be 0 or more; found -1"),
        (
            "plant.friction={coulomb: 2, static: [2,1,2]}",
            "plant.friction.static: 1 of q2 is below plant.friction.coulomb, 2; a joint at rest is held by as much",
        ),
        (
            "plant.friction={coulomb: 2, asymmetry: [1,2,-3]}",
            "plant.friction.asymmetry: -3 of q3 is more than plant.friction.coulomb, 2; such friction would drive",
        ),
        ("plant.friction.coulomb=[1,-1,1]", "plant.friction.coulomb: value 2 must be 0 or more; found [1, -1, 1]"),
        ("plant.friction.static={q2: -1}", "plant.friction.static: q2 must be 0 or more; found "),
        ("plant.friction.sigmoid.level=-1", "plant.friction.sigmoid.level: must be 0 or more; found -1"),
        ("plant.friction.sigmoid.steepness=-1", "plant.friction.sigmoid.steepness: must be 0 or more; found -1"),
        (
            "plant.friction.sigmoid={level: 1, steepness: 1e3, shift: -1}",
            "plant.friction.sigmoid.shift: -1 of q1 times plant.friction.sigmoid.steepness, 1000, must be within 700",
        ),
        ("plant.friction.stribeck_speed=0", "plant.friction.stribeck_speed: must be above 0"),
        ("plant.friction.stribeck_curve=gaus", "plant.friction.stribeck_curve: "),
        (
            "plant.friction.coulomb={q2: 1, q4: 1}",
            "plant.friction.coulomb: unknown joint 'q4'. Allowed: q1, q2, q3.",
        ),
        ("plant.friction.dry=1", "plant.friction.dry: unknown key"),
    ],
)
def test_friction_that_cannot_be(cli, override, message):
    ending = cli("robot=macro", override)
    assert ending.code == 2
    assert message in ending.err
