"""Kinds of friction: formulas, stick-slip, asymmetric rest, terminal speeds, energy and order."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from support.engines import ENGINES
from support.friction import MASS, WHEEL, friction_law, law_of_tick
from support.physics import assert_order
from support.stick_slip import STIFFNESS, exact_coulomb_period, exact_period, period_of, pulled

from runner.plants.flexibility import Flexibility
from runner.plants.flexible_joints import FlexibleJoints
from runner.plants.friction import Frictional, MotorFriction
from runner.plants.rk4 import Rk4
from runner.robots.model import RobotModel

GAZ = {
    "level": [0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489],
    "steepness": [5.1181, 9.0657, 10.136, 5.5903, 8.3469, 17.133, 10.336],
    "shift": [0.039533, 0.025882, -0.04607, 0.036194, 0.026226, -0.021047, 0.0035526],
}  # N m, s/rad, rad/s: Gaz et al. 2019, table I
STRIBECK = {"coulomb": 1.0, "static": 2.0, "stribeck_speed": 0.05}


def sigmoid(v, level, steepness, shift):
    level, steepness, shift = (np.asarray(value) for value in (level, steepness, shift))
    return level / (1.0 + np.exp(-steepness * (v + shift))) - level / (1.0 + np.exp(-steepness * shift))


@pytest.fixture(params=ENGINES)
def wheel(request, engine):
    """Make the wheel with friction, in every engine."""

    def wheel(tick, **friction):
        model = RobotModel(WHEEL, "wheel")
        return Frictional(engine(request.param, WHEEL, model, tick), model, friction_law(**friction), tick)

    return wheel


def rough(tick, **friction):
    model = RobotModel(WHEEL, "wheel")
    return Frictional(Rk4(model, tick, 1), model, friction_law(**friction), tick)


def motor(tick, **friction):
    springs = Flexibility(*(np.array([value]) for value in (1e-9, MASS, 0.0, np.inf, 0.0)))
    plant = FlexibleJoints(RobotModel(WHEEL, "wheel"), springs, tick, 1)
    around = MotorFriction(plant, friction_law(**friction), tick)
    return plant, around


def test_published_sigmoids_are_their_closed_form_at_every_speed():
    law = friction_law(7, **GAZ)
    for v in (-3.0, -0.1, -1e-9, 1e-9, 0.02, 0.5, 40.0):
        damping, level = law_of_tick(law, np.full(7, v), np.zeros(7, dtype=bool))
        np.testing.assert_allclose(damping * v, sigmoid(v, **GAZ), rtol=1e-12 if abs(v) > 1e-3 else 1e-6)
        assert not level.any()
    resting = law_of_tick(law, np.zeros(7), np.ones(7, dtype=bool))[0]
    np.testing.assert_allclose(resting, (sigmoid(1e-6, **GAZ) - sigmoid(-1e-6, **GAZ)) / 2e-6, rtol=1e-6)


def test_extreme_shifts_leave_the_sigmoid_finite():
    law = friction_law(2, level=1.0, steepness=700.0, shift=[1.0, -1.0])
    for v in (-2.0, 0.0, 1.0, 2.0):
        damping, _ = law_of_tick(law, np.full(2, v), np.zeros(2, dtype=bool))
        np.testing.assert_allclose(
            damping * v, [-1.0 if v < -1.0 else 0.0, {1.0: 0.5, 2.0: 1.0}.get(v, 0.0)], atol=1e-12
        )


@pytest.mark.parametrize(("curve", "exponent"), [("exponential", 1), ("gauss", 2)])
def test_dry_friction_falls_from_the_static_level_along_stribecks_curve(curve, exponent):
    law = friction_law(2, **{**STRIBECK, "stribeck_speed": {"q1": 0.05}}, stribeck_curve=curve)
    held = np.array([False, False])
    for v in (-0.1, 0.05):
        level = law_of_tick(law, np.full(2, v), held)[1]
        np.testing.assert_allclose(level, [1.0 + np.exp(-((abs(v) / 0.05) ** exponent)), 1.0], rtol=1e-14)
    np.testing.assert_array_equal(law_of_tick(law, np.full(2, 1.0), ~held)[1], [2.0, 2.0])


def test_a_static_level_by_name_leaves_the_other_joints_their_coulomb_level():
    law = friction_law(2, coulomb=1.0, static={"q2": 3.0})
    np.testing.assert_array_equal(law.stiction, [0.0, 2.0])
    np.testing.assert_array_equal(law.of(slice(1, 2)).stiction, [2.0])


@pytest.mark.costs(2)
def test_stick_slip_on_a_pulled_spring_has_the_exact_period(wheel):
    t, q = pulled(wheel(1e-3, coulomb=1.0, static=2.0), 1e-3, 3.2)
    exact = exact_coulomb_period(1.0, 2.0)
    assert exact_period(lambda v: 1.0, 2.0) == pytest.approx(exact, rel=1e-6)
    assert period_of(t, q) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize(("curve", "exponent"), [("exponential", 1), ("gauss", 2)])
def test_stick_slip_along_stribecks_curve_has_the_exact_period(curve, exponent):
    t, q = pulled(rough(1e-3, **STRIBECK, stribeck_curve=curve), 1e-3, 4.0)
    exact = exact_period(lambda v: 1.0 + np.exp(-((max(v, 0.0) / 0.05) ** exponent)), 2.0)
    assert period_of(t, q) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("start", [0.04, -0.04])
def test_a_mass_on_a_spring_rests_where_asymmetric_levels_leave_it(wheel, start):
    """A swing ends as far beyond its middle, where friction equals the spring, as it began before it."""
    up, down = 1.5, 0.5  # N m
    plant = wheel(1e-3, coulomb=1.0, asymmetry=0.5)
    plant.reset(np.array([start]), np.zeros(1))
    for _ in range(600):
        plant.advance(-STIFFNESS * plant.q)
    end = 2.0 * (down if start > 0.0 else -up) / STIFFNESS - start
    assert -down < -STIFFNESS * end < up
    assert abs(plant.dq[0]) < 1e-9
    assert plant.q[0] == pytest.approx(end, abs=5e-4)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("make", [rough, lambda tick, **friction: motor(tick, **friction)[1]], ids=["joint", "motor"])
def test_a_joint_is_held_up_to_the_static_level_of_each_direction(make, sign):
    plant = make(1e-3, coulomb=1.0, asymmetry=0.5, static=2.0)
    level = 2.0 + sign * 0.5
    plant.reset(np.zeros(1), np.zeros(1))
    for _ in range(50):
        plant.advance(np.array([sign * 0.999 * level]))
    assert plant.friction == pytest.approx([sign * 0.999 * level])
    for _ in range(51):
        plant.advance(np.array([sign * 1.001 * level]))
    assert plant.friction == pytest.approx([sign * (level - 1.0)], rel=1e-9)  # the Coulomb level


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_constant_torque_ends_at_the_speed_where_friction_equals_it(wheel, sign):
    friction = {"viscous": 0.8, "coulomb": 0.5, "asymmetry": 0.2, "level": 1.0, "steepness": 8.0, "shift": 0.03}
    plant = wheel(2e-2, **friction)
    plant.reset(np.zeros(1), np.zeros(1))
    for _ in range(700):
        plant.advance(np.array([sign * 2.0]))
    own = friction["level"], friction["steepness"], friction["shift"]
    exact = brentq(lambda v: 0.8 * v + sigmoid(v, *own) + sign * 0.5 + 0.2 - sign * 2.0, -5.0, 5.0)
    assert plant.dq[0] == pytest.approx(exact, rel=1e-6)


KINDS = [
    {**STRIBECK, "stribeck_speed": 0.5},
    {**STRIBECK, "stribeck_speed": 0.5, "stribeck_curve": "exponential"},
    {"coulomb": 1.0, "asymmetry": -0.7},
    {"level": 1.5, "steepness": 4.0, "shift": 0.1},
]


@pytest.mark.parametrize("friction", KINDS, ids=["gauss", "exponential", "asymmetric", "sigmoid"])
def test_each_kind_is_of_first_order_in_the_tick(wheel, friction):
    def slope(_, v):
        law = friction_law(**friction)
        damping, level = law_of_tick(law, v, np.array([False]))
        return (1.0 - damping * v - level * np.sign(v) - np.array(law.asymmetry)) / MASS

    exact = solve_ivp(slope, (0.0, 0.4), [-2.0], rtol=1e-10, atol=1e-12).y[0, -1]

    def error(tick):
        plant = wheel(tick, **friction)
        plant.reset(np.zeros(1), np.array([-2.0]))
        for _ in range(round(0.4 / tick)):
            plant.advance(np.array([1.0]))
        return abs(plant.dq[0] - exact)

    errors = [error(4e-3), error(2e-3)]
    if friction.get("asymmetry"):
        assert max(errors) < 1e-9  # a constant torque
    else:
        assert errors[1] > 1e-6
        assert_order(errors, 1, within=0.05)


@given(st.integers(0, 2**32 - 1))
def test_no_kind_of_friction_drives_a_joint(macro, seed):
    """Its torque times the speed at the end of the tick is never above 0, and at rest it lies within its set."""
    draw, h = np.random.default_rng(seed), 10.0 ** np.random.default_rng(seed).uniform(-4, -1.5)
    coulomb = draw.exponential(5.0, 3) * draw.integers(0, 2, 3)
    static = coulomb + draw.exponential(5.0, 3) * draw.integers(0, 2, 3)
    law = friction_law(
        3,
        viscous=(draw.exponential(3.0, 3) * draw.integers(0, 2, 3)).tolist(),
        coulomb=coulomb.tolist(),
        asymmetry=(coulomb * draw.uniform(-1.0, 1.0, 3)).tolist(),
        static=static.tolist(),
        stribeck_speed=float(10.0 ** draw.uniform(-3, 1)),
        stribeck_curve=["exponential", "gauss"][draw.integers(0, 2)],
        level=(draw.exponential(5.0, 3) * draw.integers(0, 2, 3)).tolist(),
        steepness=draw.exponential(20.0, 3).tolist(),
        shift=draw.normal(0.0, 0.1, 3).tolist(),
    )
    q, dq, tau = draw.normal(size=3), draw.normal(size=3) * draw.integers(0, 2, 3), draw.normal(0.0, 40.0, 3)
    plant = Frictional(Rk4(macro, h, 1), macro, law, h)
    plant.reset(q, dq)
    plant.advance(tau)
    end = dq + h * macro.forward_dynamics(q, dq, tau - plant.friction)
    rounding = 1e-9 * (np.abs(dq).max() + np.abs(end).max())
    assert (plant.friction * end >= -rounding * np.abs(plant.friction)).all()
    resting = np.abs(end) <= rounding
    beyond = (
        np.abs(plant.friction - law.asymmetry)
        - static
        - (np.array(law.viscous) + np.max(law.slopes, axis=0)) * rounding
    )
    assert (beyond[resting] <= 1e-9 * static[resting].max(initial=0.0)).all()


def test_a_motor_behind_a_spring_follows_the_same_law():
    friction = {**STRIBECK, "asymmetry": 0.3, "level": 0.5, "steepness": 8.0, "shift": 0.1, "viscous": 0.2}
    joint, (springs, around) = rough(1e-3, **friction), motor(1e-3, **friction)
    for plant in (joint, around):
        plant.reset(np.zeros(1), np.array([0.3]))
    for k in range(1500):
        torque = np.array([4.0 * np.sin(0.01 * k)])
        joint.advance(torque)
        around.advance(torque)
        assert springs.dtheta[0] == pytest.approx(joint.dq[0], abs=1e-6)
