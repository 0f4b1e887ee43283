"""Armature in every engine: accelerations, closed loops, a closed form, friction and springs around it, and walls."""

import numpy as np
import pytest
from support.arms import checked, model_of, urdf_of

from runner.assembly.assemble import assemble
from runner.base.errors import ConfigError
from runner.plants.mujoco import Mujoco
from runner.plants.rk4 import Rk4
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders

pytest.importorskip("pybullet", reason="PyBullet is not installed")

from runner.plants.bullet_engine import LinksTorque

GEARED = ("robot=xarm7", "robot.armature=assumed", "controller=computed_torque", "trajectory=quintic",
          "trajectory.duration=0.5", "duration=0.6", "controller.period=0.002", "plant.step=0.001")  # fmt: skip


def followed(*overrides):
    config = checked(*overrides)
    loop = assemble(config)
    try:
        return simulate(loop, make_encoders(loop, config.noise, 0, 0))
    finally:
        loop.plant.close()


def test_links_get_the_torque_that_gives_the_accelerations_of_the_whole():
    generator = np.random.default_rng(5)
    links, A = model_of("xarm7", "flange"), generator.uniform(0.0, 2.0, 7)
    whole = links.with_armature(A)
    compiled, interpreted = LinksTorque(whole), LinksTorque(whole)
    assert compiled._compiled is not None
    interpreted._compiled = None
    for gravity in ([0.0, 0.0, -9.81], [3.0, -1.0, 2.0]):
        for each in (compiled, interpreted):
            each.set_gravity(np.array(gravity))
        links.pin_model.gravity.linear = whole.pin_model.gravity.linear = np.array(gravity)
        for q, dq, tau in generator.uniform(-2.0, 2.0, (10, 3, 7)):
            M, h = links.mass_matrix(q), links.coriolis_torque(q, dq) + links.gravity_torque(q)
            expected = M @ np.linalg.solve(M + np.diag(A), tau - h) + h
            for each in (compiled, interpreted):
                np.testing.assert_allclose(each.at(q, dq, tau), expected, rtol=0, atol=1e-11)
            np.testing.assert_allclose(
                links.forward_dynamics(q, dq, expected), whole.forward_dynamics(q, dq, tau), rtol=1e-8, atol=1e-8
            )


@pytest.mark.bullet
@pytest.mark.parametrize("steps", [1, 4])
def test_bullet_moves_as_mujoco_s_euler_under_any_torque(steps):
    from runner.plants.bullet_engine import Bullet

    config, generator = checked("robot=xarm7", "robot.armature=assumed"), np.random.default_rng(2)
    arm, worst = config.arm, 0.0
    plants = Bullet(arm.urdf, arm.model, 1e-3, steps), Mujoco(arm.urdf, arm.model, 1e-3, steps, "euler", 1e-9)
    try:
        for plant in plants:
            plant.reset(arm.home, np.zeros(7))
        for _ in range(200):
            tau = arm.model.gravity_torque(plants[0].q) + generator.uniform(-5.0, 5.0, 7)
            for plant in plants:
                plant.advance(tau)
            worst = max(worst, np.abs(plants[0].q - plants[1].q).max())
        assert np.abs(plants[0].q - arm.home).max() > 0.03
        np.testing.assert_allclose(plants[0].mass_matrix(arm.home), arm.model.mass_matrix(arm.home), atol=1e-12)
        np.testing.assert_allclose(plants[1].mass_matrix(arm.home), arm.model.mass_matrix(arm.home), atol=1e-12)
    finally:
        plants[0].close()
    assert worst < 1e-10


@pytest.mark.costs(2)
def test_runge_kutta_is_mujoco_s_in_a_closed_loop():
    ours, theirs = followed(*GEARED, "plant=rk4"), followed(*GEARED, "plant=mujoco", "plant.integrator=rk4")
    assert ours.failure is theirs.failure is None
    assert np.ptp(ours.tip, axis=0).max() > 0.02
    assert np.linalg.norm(ours.tip - theirs.tip, axis=1).max() < 1e-9


@pytest.mark.bullet
@pytest.mark.costs(2)
@pytest.mark.parametrize("more", [(), ("plant.friction.viscous=2", "plant.friction.coulomb=1")], ids=["free", "rough"])
def test_bullet_is_mujoco_s_euler_in_a_closed_loop(more):
    bullet, mujoco = (followed(*GEARED, f"plant={plant}", *more) for plant in ("bullet", "mujoco"))
    assert bullet.failure is mujoco.failure is None
    assert np.ptp(bullet.tip, axis=0).max() > 0.02
    assert np.linalg.norm(bullet.tip - mujoco.tip, axis=1).max() < 1e-8


@pytest.mark.bullet
def test_bullet_around_springs_feels_the_armature_of_its_rigid_joints():
    springs = ("robot=macro", "robot.armature=[2,0.5,0.3]", "plant.flexible_joints.motor_inertia=null",
               "plant.flexible_joints.stiffness=[1e4,null,null]", "trajectory=quintic", "trajectory.duration=1",
               "trajectory.goal=[0.4,0.7,0.6]", "duration=0.5", "plant.step=0.0005")  # fmt: skip
    bullet, mujoco = (followed(*springs, f"plant={engine}_flexible") for engine in ("bullet", "mujoco"))
    assert bullet.failure is mujoco.failure is None
    assert np.linalg.norm(bullet.tip - mujoco.tip, axis=1).max() < 1e-8


ONE_JOINT = """<robot name="one"><link name="base"><inertial><mass value="0"/>
<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"><inertial><mass value="1"/><origin xyz="0 0 0"/>
<inertia ixx="3" iyy="3" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="q" type="revolute">
<parent link="base"/><child link="tip"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1e9" velocity="1e9"/>
</joint></robot>"""


@pytest.mark.bullet
def test_one_joint_under_constant_torque_is_the_closed_form(one_joint):
    """The angle is tau t^2 / (2 (I + A)); semi-implicit Euler is ahead by half a step of the speed."""
    tau, steps, h, inertia = 2.0, 100, 1e-3, 3.0 + 1.5
    time, speed = steps * h, tau * steps * h / inertia
    for plant, ahead in one_joint(h, steps):
        plant.reset(np.zeros(1), np.zeros(1))
        plant.advance(np.array([tau]))
        assert plant.dq[0] == pytest.approx(speed, rel=1e-12)
        assert plant.q[0] == pytest.approx(0.5 * speed * time + ahead * speed * h, rel=1e-12)
        plant.close()


@pytest.fixture
def one_joint():
    """Return every engine with a joint of inertia 3 and armature 1.5 kg m^2, and how far it is ahead, in steps."""
    from runner.plants.bullet_engine import Bullet
    from runner.robots.model import RobotModel

    model = RobotModel(ONE_JOINT, "tip", 0.0).with_armature(np.array([1.5]))

    def made(h, steps):
        yield Rk4(model, h, steps), 0.0
        yield Mujoco(ONE_JOINT, model, h, steps, "rk4", 1e-9), 0.0
        yield Mujoco(ONE_JOINT, model, h, steps, "euler", 1e-9), 0.5
        yield Bullet(ONE_JOINT, model, h, steps), 0.5

    return made


@pytest.mark.parametrize("robot", ["planar", "xarm7"])
def test_rk4_and_mujoco_accelerate_as_the_model(robot):
    model = model_of(robot, "tip" if robot == "planar" else "flange").with_armature(
        np.full(2 if robot == "planar" else 7, 0.4)
    )
    q, tau, h = np.full(model.nq, 0.3), np.linspace(1.0, 2.0, model.nq), 1e-5
    expected = model.forward_dynamics(q, np.zeros_like(q), tau)
    for plant in (Rk4(model, h, 1), Mujoco(urdf_of(robot), model, h, 1, "euler", 1e-9)):
        plant.reset(q, np.zeros_like(q))
        plant.advance(tau)
        np.testing.assert_allclose(plant.dq / h, expected, atol=1e-4 * np.abs(expected).max())
        plant.close()


@pytest.mark.bullet
@pytest.mark.parametrize("tool", [(), ("robot.tool=null",)], ids=["tool", "tip"])
def test_a_wall_on_bullet_is_refused(tool):
    config = checked("robot=meca500", "robot.armature=assumed", "environment=wall", "controller=hybrid_force", *tool)
    with pytest.raises(ConfigError, match=r"environment.kind: a wall found together with robot.armature.*plant=mujoco"):
        assemble(config)
