"""Every shipped robot on random postures within its joint limits: dynamics against differences."""

import re

import numpy as np
import pytest
import yaml

from runner.assembly.arms import build_robot, read_outline
from runner.base.paths import robots_dir
from runner.config.compose.compose import compose
from runner.config.compose.files import group_options
from runner.config.robot import OneArmConfig, StagedRobotConfig

ZOO = sorted(group_options("robot"))
SAMPLES = 20
PAYLOAD = ("robot.payload.mass=0.3", "robot.payload.position=[0.01,-0.02,0.03]")


def config_of(name, *overrides):
    # The robots' own controllers are of no interest here.
    values = compose((f"robot={name}", "controller=operational_space", "trajectory=goal", *overrides)).resolved["robot"]
    return (StagedRobotConfig if "stages" in values else OneArmConfig).model_validate(values)


def robot(name, *overrides):
    return build_robot(read_outline(config_of(name, *overrides)), 9.81)


@pytest.fixture(scope="module", params=ZOO)
def name(request):
    return request.param


@pytest.fixture(scope="module")
def model(name):
    return robot(name).model


def postures(model, seed=0):
    lower, upper = np.clip(model.position_limits, -np.pi, np.pi)
    return np.random.default_rng(seed).uniform(lower, upper, (SAMPLES, model.nq))


def differences(function, q, h=1e-6):
    """Central differences of a function along each joint, the joint last."""
    return np.stack([(function(q + h * e) - function(q - h * e)) / (2.0 * h) for e in np.eye(len(q))], axis=-1)


def test_the_linear_jacobian_is_the_gradient_of_the_tip(model):
    for q in postures(model):
        np.testing.assert_allclose(model.tip_jacobian(q)[:3], differences(model.tip_position, q), atol=2e-9)


def test_the_angular_jacobian_is_the_rate_of_the_tip_s_rotation(model):
    for q in postures(model):
        rotation = model.tip_pose(q)[:3, :3]
        for joint, rate in enumerate(np.moveaxis(differences(lambda q: model.tip_pose(q)[:3, :3], q), -1, 0)):
            skew = rate @ rotation.T
            np.testing.assert_allclose(
                model.tip_jacobian(q)[3:, joint], [skew[2, 1], skew[0, 2], skew[1, 0]], atol=2e-9
            )


def test_gravity_is_the_gradient_of_the_energy(model):
    rest = np.zeros(model.nq)
    for q in postures(model):
        gradient = differences(lambda q: np.array(model.energy(q, rest)), q)
        np.testing.assert_allclose(model.gravity_torque(q), gradient, atol=1e-7)


@pytest.mark.bullet
@pytest.mark.parametrize("overrides", [(), PAYLOAD], ids=["unloaded", "loaded"])
def test_both_engines_have_the_same_dynamics(name, overrides):
    import pybullet

    from runner.plants.bullet_engine import Bullet

    arm = robot(name, *overrides)
    model, plant = arm.model, Bullet(arm.urdf, arm.model, 1e-3, 1)
    generator = np.random.default_rng(1)
    try:
        for q in postures(model):
            dq, ddq = generator.uniform(-1.0, 1.0, (2, model.nq))
            state = [values.tolist() for values in (q, dq, ddq)]
            theirs = pybullet.calculateInverseDynamics(plant._body, *state, physicsClientId=plant._client)
            ours = model.mass_matrix(q) @ ddq + model.coriolis_torque(q, dq) + model.gravity_torque(q)
            theirs = theirs + model.armature * ddq  # which PyBullet does not know
            # PyBullet turns every tensor into its principal axes: 1e-10 of the largest torque, or 1e-10 N m.
            np.testing.assert_allclose(theirs, ours, rtol=0, atol=1e-10 * max(1.0, np.abs(ours).max()))
    finally:
        plant.close()


def test_a_payload_adds_the_torque_of_its_weight_and_its_inertia(name, model):
    loaded = robot(name, *PAYLOAD).model
    mass, place, g = 0.3, np.array([0.01, -0.02, 0.03]), 9.81
    assert loaded.mass == pytest.approx(model.mass + mass, rel=1e-14)
    for q in postures(model):
        J, rotation = model.tip_jacobian(q), model.tip_pose(q)[:3, :3]
        J_load = J[:3] - np.cross(rotation @ place, J[3:].T).T  # velocity of the payload, v + omega x r
        np.testing.assert_allclose(
            loaded.gravity_torque(q) - model.gravity_torque(q), mass * g * J_load[2], rtol=0, atol=1e-11
        )
        np.testing.assert_allclose(
            loaded.mass_matrix(q) - model.mass_matrix(q), mass * J_load.T @ J_load, rtol=0, atol=1e-12
        )


def test_the_list_tells_joints_reach_and_payload(name, model):
    told = group_options("robot")[name]
    found = re.search(r": (\d+) joints, reach ([\d.]+) m, payload (not stated|[\d.]+ kg); ", told)
    joints, reach, payload = found.groups()
    rated = config_of(name).rated_payload
    assert (int(joints), payload) == (model.nq, "not stated" if rated is None else f"{rated:g} kg")
    # A data sheet counts from the shoulder to the wrist or the flange; the links together are longer.
    assert 0.7 * model.reach < float(reach) < 1.005 * model.reach


def test_home_is_inside_the_limits(name, model):
    assert model.limit_margins(robot(name).home).min() > 0.1


SETS = [
    (path.name.split(".")[0], path.suffixes[0][1:], name)
    for path in sorted(robots_dir().glob("*.*.yaml"))
    for name in yaml.safe_load(path.read_text())
]


@pytest.mark.parametrize(("name", "key", "set_"), SETS)
def test_every_named_set_makes_an_arm_of_positive_mass_matrix(name, key, set_):
    arm = robot(name, f"robot.{key}={set_}").model
    assert min(np.linalg.eigvalsh(arm.mass_matrix(q))[0] for q in postures(arm)) > 0.0


@pytest.mark.parametrize(("name", "rated"), [("xarm7", 3.5), ("meca500", 0.5), ("meca500_r4", 0.5)])
def test_a_payload_beyond_the_rating_is_warned_of_and_built(name, rated):
    assert config_of(name, "robot.tool=null", f"robot.payload.mass={rated}").warnings == []
    config = config_of(name, "robot.tool=null", f"robot.payload.mass={rated + 0.1}")
    (warning,) = config.warnings
    assert warning.startswith(f"robot.payload.mass: {rated + 0.1:g} kg is more than the {rated:g} kg that {name} is")
    bare = build_robot(read_outline(config_of(name, "robot.tool=null")), 9.81).model.mass
    assert build_robot(read_outline(config), 9.81).model.mass > bare + rated


def test_the_r4_is_the_r3_with_faster_joints():
    r3, r4 = robot("meca500").model, robot("meca500_r4").model
    np.testing.assert_allclose(np.rad2deg(r4.velocity_limits), [225, 225, 225, 350, 350, 500], atol=1e-4)
    np.testing.assert_array_equal(r4.position_limits, r3.position_limits)
    np.testing.assert_array_equal(r4.effort_limits, r3.effort_limits)
