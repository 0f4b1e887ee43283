"""A wall that the tip of an arm touches within the integration steps of any plant."""

import numpy as np
import pytest

from runner.assembly.assemble import assemble
from runner.environments import ENVIRONMENTS
from runner.environments.wall import WallConfig
from runner.plants.wrappers import WithTipContact

POSTURES = {"macro": [0.3, 0.4, -0.5], "mini": [0.3, 0.4, -0.5]}
ENGINES = {
    "rk4": ("plant=rk4",),
    "bullet": ("plant=bullet",),
    "mujoco": ("plant=mujoco", "plant.integrator=euler"),
    "mujoco rk4": ("plant=mujoco", "plant.integrator=rk4"),
}
NORMAL = np.array([0.0, -np.cos(0.5), -np.sin(0.5)])


def touching(checked_config, robot, engine, step, *, distance=0.0, damping=0.0, friction=0.0, stiffness=1e4):
    """Return a config and its plant without gravity, of one step a tick, with the tip at a wall."""
    config = checked_config(
        f"robot={robot}",
        *ENGINES[engine],
        f"robot.home={POSTURES[robot]}",
        f"controller.period={step}",
        f"plant.step={step}",
        "environment=wall",
        f"environment.normal={NORMAL.tolist()}",
        f"environment.distance={distance}",
        f"environment.stiffness={stiffness}",
        f"environment.damping={damping}",
        f"environment.friction={friction}",
    )
    plant = assemble(config).plant
    assert isinstance(plant, WithTipContact)
    plant.set_gravity(np.zeros(3))
    return config, plant


def towards(model, q, velocity):
    """Return joint velocities that move the tip by one, and by nothing that loads another direction than the normal's.

    They are those of a mass that moves along the force that will stop it: dq = M^-1 J^T n times what brings the speed.
    """
    J = model.tip_jacobian(q)[:3]
    way = np.linalg.solve(model.mass_matrix(q), J.T @ NORMAL)
    return way * velocity / (NORMAL @ J @ way)


@pytest.mark.parametrize(("robot", "stiffness"), [("macro", 1e4), ("mini", 1e4)])
@pytest.mark.parametrize("engine", ENGINES)
def test_the_peak_of_an_impact_is_that_of_a_mass_on_a_spring(checked_config, engine, robot, stiffness):
    speed, step = 0.1, 1e-4
    config, plant = touching(checked_config, robot, engine, step, stiffness=stiffness)
    model, q = config.arm.model, np.array(POSTURES[robot])
    J = model.tip_jacobian(q)[:3]
    mass = 1.0 / (NORMAL @ J @ np.linalg.solve(model.mass_matrix(q), J.T @ NORMAL))
    plant.reset(q, towards(model, q, -speed))
    forces = []
    for _ in range(round(np.pi * np.sqrt(mass / stiffness) / step)):
        plant.advance(np.zeros(3))
        forces.append(plant.contact_wrench()[:3] @ NORMAL)
    plant.close()
    assert max(forces) == pytest.approx(speed * np.sqrt(stiffness * mass), rel=0.005 if engine == "rk4" else 0.01)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_undamped_wall_gives_the_motion_back(checked_config, engine):
    config, plant = touching(checked_config, "macro", engine, 1e-4)
    model, q = config.arm.model, np.array(POSTURES["macro"])
    dq = towards(model, q, -0.1)
    plant.reset(q, dq)
    energy = 0.5 * dq @ model.mass_matrix(q) @ dq
    for _ in range(500):
        plant.advance(np.zeros(3))
    kept = 0.5 * plant.dq @ model.mass_matrix(plant.q) @ plant.dq
    touch = np.abs(plant.contact_wrench()).max()
    plant.close()
    assert touch == 0.0
    assert kept == pytest.approx(energy, rel=1e-3)


def test_the_force_is_felt_where_the_tip_is(checked_config):
    config, plant = touching(checked_config, "macro", "rk4", 1e-3, distance=-0.001)
    q = np.array(POSTURES["macro"])
    plant.reset(q, np.zeros(3))
    wrench, tip = plant.contact_wrench(), config.arm.model.tip_position(q)
    plant.close()
    np.testing.assert_allclose(wrench[:3], 10.0 * NORMAL, rtol=1e-9)
    np.testing.assert_allclose(wrench[3:], np.cross(tip, wrench[:3]), rtol=1e-9)


@pytest.mark.parametrize("pull", [0.9, 1.5])
@pytest.mark.parametrize("engine", ["rk4", "bullet", "mujoco"])
def test_the_tip_sticks_within_the_cone_of_friction_and_slides_beyond(checked_config, engine, pull):
    config, plant = touching(checked_config, "macro", engine, 5e-4, distance=-0.001, damping=100.0, friction=0.3)
    q = np.array(POSTURES["macro"])
    model = config.arm.model
    J, along = model.tip_jacobian(q)[:3], np.array([1.0, 0.0, 0.0])
    plant.reset(q, np.zeros(3))
    for k in range(400):  # 0.2 s, the first half of it to come up to the pull without a swing
        plant.advance(J.T @ (-10.0 * NORMAL + min(1.0, k / 200) * pull * 0.3 * 10.0 * along))
    moved, force = (model.tip_position(plant.q) - model.tip_position(q)) @ along, plant.contact_wrench()[:3]
    plant.close()
    assert np.linalg.norm(force - (force @ NORMAL) * NORMAL) <= 0.3 * force @ NORMAL * (1 + 1e-9)
    assert moved < 4e-4 if pull < 1 else moved > 2e-3  # it yields by 3 N of 1e4 N/m


def test_friction_brakes_a_sliding_tip_by_its_share_of_the_push():
    wall = ENVIRONMENTS.build(
        WallConfig(kind="wall", distance=0.0, normal=[0.0, 0.0, 1.0], stiffness=1e4, damping=0.0, friction=0.25)
    )
    wall.reset(np.zeros(3))
    velocity = np.array([0.2, 0.1, 0.0])
    for k in range(100):
        force = wall.wrench(1e-3 * k, np.array([0.0, 0.0, -0.001]) + 1e-3 * k * velocity, velocity)[:3]
    np.testing.assert_allclose(force, [*(-0.25 * 10.0 * velocity[:2] / np.linalg.norm(velocity)), 10.0], rtol=1e-9)
