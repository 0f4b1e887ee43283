"""Torque laws: values that an arm hands to a law and numbers that a law keeps."""

import numpy as np
from support.arms import tip_numbers

from runner.controllers.macro_mini.stage_loops import StageLaw
from runner.controllers.operational_space.operational_space import OperationalSpace
from runner.controllers.torque_law import PinocchioArm, structure_of

NUMBERS = (30.0, 1.0, True, True, 0.3)
Q, DQ, DDQ = np.array([[0.3, -0.5, 0.7], [0.2, -0.4, 0.9], [1.0, 2.0, -1.0]])


def test_place_motion_and_tip_are_one_tip_s(macro):
    arm = PinocchioArm(macro)
    J, pose = macro.tip_jacobian(Q), macro.tip_pose(Q)
    for x, R, *velocity in (arm.tip_pose(Q), arm.tip_pose_and_twist(Q, DQ), arm.tip(Q, DQ)[:2]):
        np.testing.assert_allclose(x, pose[:3, 3], atol=1e-15)
        np.testing.assert_allclose(R, pose[:3, :3], atol=1e-15)
        if velocity:
            np.testing.assert_allclose(velocity[0], J @ DQ, atol=1e-14)
    np.testing.assert_allclose(arm.tip(Q, DQ).J, J, atol=1e-15)


def test_another_gravity_holds_for_one_question(macro):
    arm, own = PinocchioArm(macro), PinocchioArm(macro).inverse_dynamics(Q, DQ, DDQ)
    sideways = np.array([3.0, -4.0, 5.0])
    tilted = macro.copy()
    tilted.pin_model.gravity.linear = sideways
    expected = own - macro.gravity_torque(Q) + tilted.gravity_torque(Q)
    np.testing.assert_allclose(arm.inverse_dynamics(Q, DQ, DDQ, sideways), expected, atol=1e-12)
    np.testing.assert_array_equal(arm.inverse_dynamics(Q, DQ, DDQ), own)
    np.testing.assert_array_equal(macro.gravity, [0.0, 0.0, -9.81])


def test_an_arm_without_weight_has_none_whatever_is_given(macro):
    arm = PinocchioArm(macro, gravity_compensation=False)
    for gravity in (None, np.array([3.0, -4.0, 5.0])):
        expected = PinocchioArm(macro).inverse_dynamics(Q, DQ, DDQ) - macro.gravity_torque(Q)
        np.testing.assert_allclose(arm.inverse_dynamics(Q, DQ, DDQ, gravity), expected, atol=1e-12)


def test_a_law_within_a_law_is_described_by_its_kind_and_what_it_keeps(macro):
    first, other, undamped = (
        StageLaw(macro, tip_numbers(*numbers), np.zeros(3))
        for numbers in (NUMBERS, (20.0, *NUMBERS[1:]), (*NUMBERS[:4], 0.0))
    )
    kind = f"{OperationalSpace.__module__}.OperationalSpace"
    assert structure_of(first) == {"_tip": (kind, {"_damped": True})}
    assert structure_of(first) == structure_of(other) != structure_of(undamped)
