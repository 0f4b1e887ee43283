"""A law that is one function: its nominal arm, its desired motion, and computed torque written by it."""

import types

import numpy as np
import pytest
from support.arms import checked

from runner.base.errors import ConfigError
from runner.controllers.joint_space.computed_torque import ComputedTorque, ComputedTorqueConfig
from runner.controllers.joint_space.function_law import NominalArm, function_module
from runner.controllers.torque_law import PinocchioArm

ARMS = {name: checked(f"robot={name}", "controller=joint_pd", "trajectory=goal").arm for name in ("macro", "xarm7")}
VALUES = {
    "task": "position",
    "natural_frequency": 20.0,
    "damping_ratio": 1.0,
    "period": 0.01,
    "gravity_compensation": True,
    "feedforward": True,
    "singularity_damping": 0.3,
    "null_space_frequency": 20.0,
}
SEEN = []


def resolved(t, q, dq, desired, arm, kp=400.0, kd=40):
    SEEN.append(desired)
    return arm.M(q) @ (desired.ddq + kd * (desired.dq - dq) + kp * (desired.q - q)) + arm.h(q, dq)


def tip(t, q, dq, desired, arm, k=(100, 100.0, 100), on=True, mode="soft", natural_frequency=7):
    assert (on, mode, natural_frequency) == (True, "soft", 20.0)
    return arm.J(q).T @ (k * (desired.x - arm.x(q))) + arm.g(q)


def law(function, name="macro", joints=False, **changes):
    module = types.ModuleType("mine")
    module.__file__ = __file__
    made = function_module(function, function.__name__, module)
    config = made.CONFIG(**(VALUES | made.VALUES | {"natural_frequency": 20.0} | changes))
    (loop,) = made.build(config, ARMS[name], joints=joints)
    return loop.controller


def motion(name, joints, seed=3):
    """Return a few ticks of measurements and a smooth reference near home."""
    generator, arm = np.random.default_rng(seed), ARMS[name]
    size = arm.model.nq if joints else 3
    home = arm.home if joints else arm.model.tip_position(arm.home)
    for k in range(4):
        q, dq = arm.home + 0.1 * generator.normal(size=arm.model.nq), generator.normal(size=arm.model.nq)
        yield 0.01 * k, q, dq, np.array([home + 0.01 * k**2, np.full(size, 0.02 * k), np.full(size, 0.02)])


@pytest.mark.parametrize("joints", [False, True])
@pytest.mark.parametrize("name", ["macro", "xarm7"])
def test_computed_torque_as_a_function_gives_its_torques(name, joints):
    config = ComputedTorqueConfig(kind="computed_torque", integral_gain=0.0, **VALUES)
    own, ours = law(resolved, name, joints), ComputedTorque(ARMS[name].model, config, ARMS[name].home, joints)
    for given in motion(name, joints):
        np.testing.assert_allclose(own.torque(*given), ours.torque(*given), rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("name", ["macro", "xarm7"])
@pytest.mark.parametrize("gravity", [True, False])
def test_its_nominal_arm_is_the_model(name, gravity):
    model, arm = ARMS[name].model, NominalArm(PinocchioArm(ARMS[name].model, gravity))
    _, q, dq, _ = next(motion(name, True))
    np.testing.assert_allclose(arm.M(q), model.mass_matrix(q), atol=1e-14)
    np.testing.assert_allclose(arm.g(q), gravity * model.gravity_torque(q), atol=1e-12)
    np.testing.assert_allclose(
        arm.h(q, dq), model.coriolis_torque(q, dq) + gravity * model.gravity_torque(q), atol=1e-11
    )
    np.testing.assert_allclose(arm.J(q), model.tip_jacobian(q)[:3], atol=1e-14)
    np.testing.assert_allclose(arm.x(q), model.tip_position(q), atol=1e-14)


def test_what_the_arm_returns_stays_when_it_is_asked_again():
    model = ARMS["macro"].model
    arm, home = NominalArm(PinocchioArm(model)), ARMS["macro"].home
    first = [arm.M(home), arm.h(home, home), arm.g(home), arm.J(home), arm.x(home)]
    kept = [each.copy() for each in first]
    for _ in (arm.M(home + 1.0), arm.h(home + 1.0, home), arm.g(home + 1.0), arm.J(home + 1.0), arm.x(home + 1.0)):
        pass
    for each, before in zip(first, kept, strict=True):
        np.testing.assert_array_equal(each, before)


def test_the_desired_tip_of_a_joint_motion_moves_as_the_joints_do():
    SEEN.clear()
    own, model, step = law(resolved, joints=True), ARMS["macro"].model, 1e-5
    q, dq, ddq = ARMS["macro"].home + 0.1, np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, -1.0])
    for dt in (-step, 0.0, step):
        own.torque(0.0, q, dq, np.array([q + dt * dq + 0.5 * dt**2 * ddq, dq + dt * ddq, ddq]))
    before, now, after = SEEN
    np.testing.assert_array_equal(now.q, q)
    np.testing.assert_allclose(now.x, model.tip_position(q), atol=1e-14)
    np.testing.assert_allclose(now.dx, (after.x - before.x) / (2.0 * step), atol=1e-9)
    np.testing.assert_allclose(now.ddx, (after.dx - before.dx) / (2.0 * step), atol=1e-8)


@pytest.mark.parametrize("feedforward", [True, False])
def test_the_desired_tip_of_a_tip_motion_is_the_reference(feedforward):
    SEEN.clear()
    own = law(resolved, feedforward=feedforward)
    for given in motion("macro", joints=False):
        own.torque(*given)
        found = SEEN[-1]
        np.testing.assert_array_equal(found.x, given[3][0])
        np.testing.assert_array_equal([found.dx, found.ddx], feedforward * given[3][1:])
    np.testing.assert_array_equal(SEEN[0].q, next(motion("macro", joints=False))[1])  # starts where the joints are
    np.testing.assert_allclose(SEEN[1].dq, 0.01 * SEEN[0].ddq, atol=1e-15)


def test_a_list_comes_as_an_array_and_a_key_of_the_motion_by_its_name():
    model, home = ARMS["macro"].model, ARMS["macro"].home
    given = next(motion("macro", joints=False))
    torque = law(tip, k=[100.0, 200.0, 300.0]).torque(*given)
    pull = np.array([100.0, 200.0, 300.0]) * (given[3][0] - model.tip_position(given[1]))
    expected = model.tip_jacobian(given[1])[:3].T @ pull + model.gravity_torque(given[1])
    np.testing.assert_allclose(torque, expected, atol=1e-11)
    assert home.shape == torque.shape


def missing(t, q, dq, desired):
    return q


def swapped(q, t, dq, desired, arm):
    return q


def defaulted(t, q, dq, desired, arm=None):
    return q


def star(t, q, dq, desired, arm, *args, **others):
    return q


def bare(t, q, dq, desired, arm, kp, *, kd):
    return q


def typed(t, q, dq, desired, arm, kp=None, kd={}, ki=("a",), ke=[]):  # noqa: B006 - what is tested
    return q


def named(t, q, dq, desired, arm, kind="x", _hidden=1.0, model_dump=2.0):
    return q


@pytest.mark.parametrize(
    ("function", "count", "message"),
    [
        (missing, 1, r"its first arguments must be t, q, dq, desired, arm; found \(t, q, dq, desired\)"),
        (swapped, 1, r".* found \(q, t, dq, desired, arm\)"),
        (defaulted, 1, r".* found \(t, q, dq, desired, arm=None\)"),
        (star, 2, r"argument '\*args' cannot be a key"),
        (bare, 2, r"argument 'kp' has no default; a key needs a default: a number"),
        (typed, 4, r"argument 'kp' has the default None; a key needs a default: a number"),
        (named, 3, r"argument 'kind' cannot be a key; take another name"),
    ],
)
def test_a_function_with_other_arguments_is_refused_with_its_line(function, count, message):
    place = rf"controller.kind: {function.__name__} \(test_function_law.py, line {function.__code__.co_firstlineno}\): "
    with pytest.raises(ConfigError, match=place + message) as raised:
        law(function)
    assert len(raised.value.problems) == count
