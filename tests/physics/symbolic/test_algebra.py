"""Rigid-body recursion over any scalar, on floats: against Pinocchio, closed forms and differences."""

import math

import numpy as np
import pinocchio as pin
import pytest
from support import strangers
from support.arms import checked
from support.strangers import X, Y, Z

from runner.controllers.torque_law import PinocchioArm
from runner.robots.model import RobotModel
from runner.symbolic.algebra import ArmAlgebra, Factors
from runner.symbolic.arm import constants_of

OURS = ("macro", "mini", "combined", "xarm7", "meca500", "geared")


def model_of(name):
    if name in strangers.STRANGERS:
        return strangers.config(name).arm.model
    if name == "geared":
        return checked("robot=xarm7").arm.model.with_armature(np.array([0.4, 0.0, 0.2, 1.0, 0.24, 0.16, 0.16]))
    return checked(f"robot={name}").arm.model


def algebra_of(model):
    return ArmAlgebra(constants_of(model))


def states(model, count=5):
    generator = np.random.default_rng(6)
    return [generator.uniform(-2.0, 2.0, (3, model.nq)).tolist() for _ in range(count)]


def close(ours, theirs):
    np.testing.assert_allclose(np.array(ours), theirs, rtol=0.0, atol=1e-12 * max(np.abs(theirs).max(), 1e-3))


@pytest.mark.parametrize("name", [*OURS, *strangers.STRANGERS])
def test_kinematics_and_dynamics_are_pinocchio_s(name):
    model = model_of(name)
    algebra, data = algebra_of(model), model.pin_model.createData()
    for q, dq, ddq in states(model):
        x, R, J, bias = algebra.tip(q, dq)
        pose = model.tip_pose(np.array(q))
        close(x, pose[:3, 3])
        close(R, pose[:3, :3])
        close(J, model.tip_jacobian(np.array(q)))
        pin.forwardKinematics(model.pin_model, data, np.array(q), np.array(dq), np.zeros(model.nq))
        theirs = pin.getFrameClassicalAcceleration(model.pin_model, data, model.tip_frame, pin.LOCAL_WORLD_ALIGNED)
        close(bias, theirs.vector)
        close(algebra.mass_matrix(q), model.mass_matrix(np.array(q)))
        close(algebra.inverse_dynamics(q, dq, ddq), pin.rnea(model.pin_model, data, *map(np.array, (q, dq, ddq))))


@pytest.mark.parametrize("name", [*OURS, "kuka", "mixed", "crane", "scara"])
def test_the_regressor_is_pinocchio_s_and_gives_the_torques_of_the_arm_s_parameters(name):
    model = model_of(name)
    arm, data, theta = PinocchioArm(model), model.pin_model.createData(), model.inertial_parameters
    for q, dq, ddq in states(model):
        generator = np.random.default_rng(8)
        dq_r = generator.uniform(-2.0, 2.0, model.nq)
        Y = arm.regressor(*map(np.array, (q, dq, dq_r, ddq)))
        close(algebra_of(model).regressor(q, dq, dq_r.tolist(), ddq), Y)
        C = pin.computeCoriolisMatrix(model.pin_model, data, np.array(q), np.array(dq))
        torque = model.mass_matrix(np.array(q)) @ ddq + C @ dq_r + model.gravity_torque(np.array(q))
        close(Y @ theta + model.armature * ddq, torque)
        close(
            arm.inverse_dynamics(*map(np.array, (q, dq, ddq))),
            pin.rnea(model.pin_model, data, *map(np.array, (q, dq, ddq))),
        )


@pytest.mark.parametrize("name", [*OURS, "kuka", "mixed", "crane", "scara"])
def test_momenta_are_pinocchio_s_and_change_by_the_derivative_of_the_energy(name):
    model, g = model_of(name), np.array([1.0, -2.0, -9.0])
    weightless, h = PinocchioArm(model, False), 1e-6

    def lagrangian(q, dq):
        M, pin_model = model.mass_matrix(q), pin.Model(model.pin_model)
        pin_model.gravity.linear = g
        data = pin_model.createData()
        return 0.5 * dq @ M @ dq - pin.computePotentialEnergy(pin_model, data, q)

    for q, dq, _ in states(model):
        p, rate = weightless.momentum(np.array(q), np.array(dq), g)
        ours = algebra_of(model).momentum(q, dq, g.tolist())
        close(ours[0], p)
        close(ours[1], rate)
        close(p, model.mass_matrix(np.array(q)) @ dq)
        differences = [(lagrangian(q + h * e, np.array(dq)) - lagrangian(q - h * e, np.array(dq))) / (2.0 * h)
                       for e in np.eye(model.nq)]  # fmt: skip
        np.testing.assert_allclose(rate, differences, rtol=0.0, atol=1e-6 * max(np.abs(rate).max(), 1.0))


@pytest.mark.parametrize("name", ["macro", "xarm7", "mixed"])
def test_the_jacobian_and_its_rate_are_those_of_differences(name):
    algebra, h = algebra_of(model_of(name)), 1e-6
    for q, dq, _ in states(model_of(name)):
        step = h * np.array(dq)
        (before, _, J_before, _), (_, _, J, bias), (after, _, J_after, _) = (
            algebra.tip((q + sign * step).tolist(), dq) for sign in (-1.0, 0.0, 1.0)
        )
        np.testing.assert_allclose((np.array(J) @ dq)[:3], np.subtract(after, before) / (2.0 * h), atol=1e-7)
        np.testing.assert_allclose(bias, np.subtract(J_after, J_before) @ dq / (2.0 * h), atol=1e-6)


@pytest.mark.parametrize("name", ["macro", "xarm7", "mixed"])
def test_the_power_of_the_torques_is_the_change_of_the_energy(name):
    model, h = model_of(name), 1e-6
    algebra = algebra_of(model)
    for q, dq, ddq in states(model):
        speed, change = np.array(dq), np.array(ddq)
        before, after = (model.energy(q + s * h * speed, speed + s * h * change) for s in (-1.0, 1.0))
        power = np.dot(algebra.inverse_dynamics(q, dq, ddq), dq)
        assert power == pytest.approx((after - before) / (2.0 * h), rel=1e-6, abs=1e-6)


def test_the_mass_matrix_is_symmetric_and_the_inertia_of_each_acceleration():
    model = model_of("xarm7")
    algebra = algebra_of(model)
    for q, dq, _ in states(model):
        M = np.array(algebra.mass_matrix(q))
        np.testing.assert_array_equal(M, M.T)
        rest = np.array(algebra.inverse_dynamics(q, dq, [0.0] * 7))
        for joint, unit in enumerate(np.eye(7).tolist()):
            np.testing.assert_allclose(algebra.inverse_dynamics(q, dq, unit) - rest, M[joint], atol=1e-12)


def test_a_pendulum_has_its_closed_form():
    model = RobotModel(strangers.chain("pendulum", [("revolute", X)], length=0.4, mass=3.0), "tip")
    algebra, inertia = algebra_of(model), 3.0 * 0.4**2 * (1.0 / 12.0 + 1.0 / 4.0)
    (torque,) = algebra.inverse_dynamics([0.3], [5.0], [2.0])
    assert torque == pytest.approx(inertia * 2.0 - 3.0 * 9.81 * 0.2 * math.sin(0.3), rel=1e-13)


def test_a_slide_on_a_turntable_feels_centrifugal_and_coriolis_forces():
    urdf = strangers.chain("arm", [("revolute", Z), ("prismatic", X)], length=0.3, mass=2.0)
    algebra = algebra_of(RobotModel(urdf, "tip"))
    # The second link's centre is at x = s: force -m s w^2 along the slide, moment 2 m s s' w about the axis.
    turn, push = algebra.inverse_dynamics([0.7, 0.2], [3.0, 0.5], [0.0, 0.0])
    assert push == pytest.approx(-2.0 * 0.2 * 9.0, rel=1e-12)
    assert turn == pytest.approx(2.0 * 2.0 * 0.2 * 0.5 * 3.0, rel=1e-12)


def test_an_axis_that_is_none_of_the_frame_s_is_turned_to_z():
    askew = RobotModel(strangers.chain("arm", [("revolute", "1 2 3"), ("prismatic", "0 -1 1"), ("revolute", Y)]), "tip")
    algebra, data = algebra_of(askew), askew.pin_model.createData()
    for q, dq, ddq in states(askew):
        close(algebra.tip(q, dq)[2], askew.tip_jacobian(np.array(q)))
        close(algebra.inverse_dynamics(q, dq, ddq), pin.rnea(askew.pin_model, data, *map(np.array, (q, dq, ddq))))


def test_factors_solve_and_tell_what_is_positive_definite():
    generator = np.random.default_rng(1)
    A = generator.normal(size=(5, 5))
    A, b = A @ A.T, generator.normal(size=5)
    factors = Factors(np.triu(A).tolist())  # only the upper triangle is read
    np.testing.assert_allclose(factors.solve(b.tolist()), np.linalg.solve(A, b), rtol=1e-9)
    np.testing.assert_allclose(np.array(factors.inverse()) @ A, np.eye(5), atol=1e-9)
    assert min(factors.pivots) > 0.0
    assert min(Factors((A - 1.001 * np.linalg.eigvalsh(A)[0] * np.eye(5)).tolist()).pivots) < 0.0
    assert min(Factors((A - 0.999 * np.linalg.eigvalsh(A)[0] * np.eye(5)).tolist()).pivots) > 0.0
