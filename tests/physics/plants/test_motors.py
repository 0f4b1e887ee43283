"""Friction and brakes of motors behind flexible joints, against closed forms."""

import numpy as np
import pytest
from support.friction import friction_law

from runner.plants.flexibility import Flexibility
from runner.plants.flexible_joints import FlexibleJoints
from runner.plants.friction import MotorFriction, stopping_torques
from runner.robots.model import RobotModel

ONE_JOINT = """<robot name="one"><link name="base"/><link name="arm"><inertial><mass value="1"/><origin xyz="0 0 0"/>
<inertia ixx="3" iyy="3" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="q" type="revolute">
<parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1e9" velocity="1e9"/>
</joint></robot>"""  # 3 kg m^2
B, K = 0.5, 200.0  # kg m^2, N m/rad
TICK = 1e-3  # s


def rubbed(viscous=0.0, coulomb=0.0, braked=np.inf, motor=B, **more):
    springs = Flexibility(*(np.array([value]) for value in (K, motor, 0.0, braked, 0.0)))
    plant = FlexibleJoints(RobotModel(ONE_JOINT, "arm"), springs, TICK, 1)
    return plant, MotorFriction(plant, friction_law(viscous=viscous, coulomb=coulomb, **more), TICK)


def test_a_motor_within_its_dry_friction_stands_still_and_takes_what_drives_it():
    plant, around = rubbed(coulomb=1.0)
    around.reset(np.zeros(1), np.zeros(1))
    for _ in range(200):
        around.advance(np.array([0.7]))
    assert abs(plant.theta[0]) < 1e-12
    assert around.friction == pytest.approx([0.7], abs=1e-9)


def test_beyond_it_the_link_gets_what_is_left():
    plant, around = rubbed(coulomb=1.0, motor=5.0)  # too heavy to turn back
    around.reset(np.zeros(1), np.zeros(1))
    for _ in range(1000):
        around.advance(np.array([3.0]))
    assert 5.0 * plant.dtheta[0] + 3.0 * plant.dq[0] == pytest.approx(2.0 * 1.0, rel=1e-9)  # momentum: N m times s


def test_viscous_friction_lets_motor_and_link_turn_at_torque_over_friction_in_the_end():
    plant, around = rubbed(viscous=4.0)
    around.reset(np.zeros(1), np.zeros(1))
    for _ in range(20000):
        around.advance(np.array([2.0]))
    assert plant.dtheta[0] == pytest.approx(0.5, rel=1e-3)  # rad/s
    assert plant.dq[0] == pytest.approx(0.5, rel=1e-3)


def test_a_braked_motor_stands_still_and_the_link_swings_on_its_spring_alone():
    plant, around = rubbed(braked=0.0)
    around.reset(np.zeros(1), np.zeros(1))
    q = []
    for _ in range(2000):
        around.advance(np.array([50.0]))  # on the motor
        q.append(plant.q[0])
    assert plant.theta[0] == 0.0
    assert not np.any(q)
    plant.q[:] = 0.01
    for _ in range(round(2.0 * np.pi * np.sqrt(3.0 / K) / TICK)):  # a period
        around.advance(np.zeros(1))
    assert plant.q[0] == pytest.approx(0.01, rel=1e-4)


def test_the_world_pushes_links_and_not_motors():
    plant, around = rubbed(braked=0.0)
    around.reset(np.zeros(1), np.zeros(1))
    q = []
    for _ in range(4000):
        around.push(np.zeros(1), np.array([2.0]))
        q.append(plant.q[0])
    assert np.max(q) == pytest.approx(2.0 * 2.0 / K, rel=1e-4)  # twice the deflection at rest


def test_a_brake_that_closes_on_the_way_leaves_the_link_its_speed():
    plant, around = rubbed(braked=0.1)
    around.reset(np.zeros(1), np.full(1, 0.2))
    for _ in range(100):
        around.advance(np.zeros(1))
    assert plant.theta[0] == pytest.approx(0.02, rel=1e-9)
    q = []
    for _ in range(1000):
        around.advance(np.zeros(1))
        q.append(plant.q[0] - 0.02)
    assert plant.theta[0] == pytest.approx(0.02, rel=1e-9)
    assert np.max(q) == pytest.approx(0.2 / np.sqrt(K / 3.0), rel=1e-3)


@pytest.mark.parametrize("torque", [0.3, 0.9, -2.5])
@pytest.mark.parametrize("viscous", [0.0, 4.0])
def test_motors_have_the_friction_law_of_joints(torque, viscous):
    plant, around = rubbed(viscous, coulomb=1.0)
    around.reset(np.zeros(1), np.full(1, 0.001))
    mobility = np.array([[TICK / (B + TICK * viscous)]])
    speed = mobility[0] * (B * plant.dtheta / TICK + torque - plant.spring_torque())
    mu, _ = stopping_torques(mobility, speed, np.ones(1), np.zeros(1))
    around.advance(np.array([torque]))
    assert around.friction == pytest.approx(viscous * (speed - mobility @ mu) + mu, rel=1e-12)
