"""Torque constants of motors whose currents are logged, from logs with different known payloads."""

import numpy as np
import pinocchio as pin
import pytest
from support.identified_logs import KnownArm

from runner.identification.examination import find_weak
from runner.identification.fit import constant_name, fit_logs, name_of
from runner.identification.held_out import file_share, predict_held_out
from runner.identification.log_rows import log_rows, payload_torques
from runner.recordings.columns_map import FixedPayload

PAYLOAD = FixedPayload(mass=2.0, position=[0.0, 0.05, 0.1])


def logs_of(robot, gains, carried=(None, PAYLOAD), size=0.0, exact=True, seed=0):
    """Return an arm and the rows of its logs; a recorded torque times its gain is the true one."""
    arm, random, rows = KnownArm(robot), np.random.default_rng(seed), []
    for number, payload in enumerate(carried):
        arm.carried = payload
        *motion, tau = arm.log(16.0, first=30.0 * number)
        noisy = tau + size * tau.std(axis=0) * random.normal(size=tau.shape)
        rows.append(log_rows(arm.rows((*motion, noisy / gains), exact=exact), arm.sums, True, f"{number}", payload))
    return arm, rows


@pytest.mark.costs(2)
@pytest.mark.parametrize("gain", [0.3, 1.0, 3.0])
def test_the_constants_and_the_model_are_found_from_a_first_value_within_a_factor_of_three(gain):
    gains = gain * np.array([1.0, 1.2, 0.9])
    arm, rows = logs_of("macro", gains)
    fit = fit_logs(rows, "coulomb", currents=range(3))
    np.testing.assert_allclose(fit.state.scales, gains, rtol=1e-9)
    np.testing.assert_allclose(fit.state.values[: len(arm.base)], arm.base, atol=1e-8)


@pytest.mark.costs(3)
def test_noise_does_not_pull_the_constants_down_and_their_intervals_hold_them():
    gains, misses = np.array([0.7, 1.0, 1.4]), []
    for seed in range(6):
        _, rows = logs_of("macro", gains, size=0.1, exact=False, seed=seed)
        fit = fit_logs(rows, "coulomb", currents=range(3))
        layout = fit.state.layout
        misses.append((fit.state.scales / gains - 1.0) / fit.halves[layout.constants : layout.delay])
    assert np.mean(np.abs(misses) < 1.0) > 0.8
    assert np.abs(np.mean(misses)) < 0.3


def test_a_payload_that_no_log_lacks_could_be_part_of_the_last_link():
    _, rows = logs_of("macro", np.ones(3), (PAYLOAD, PAYLOAD))
    fit = fit_logs(rows, "coulomb", currents=range(3))
    layout = fit.state.layout
    names = [name_of(layout, column, [], ("q1", "q2", "q3")) for column in range(layout.constants, layout.delay)]
    assert names == [constant_name(joint) for joint in ("q1", "q2", "q3")]
    assert len(set(range(layout.constants, layout.delay)) - set(fit.taken)) == 1


def test_a_known_payload_is_not_taken_for_the_arm():
    arm, (rows,) = logs_of("macro", np.ones(3), (PAYLOAD,))
    fit = fit_logs([rows], "load")
    np.testing.assert_allclose(fit.state.values[: len(arm.base)], arm.base, atol=1e-6)
    assert not find_weak(fit)
    assert predict_held_out(fit, [rows]).share() < 1e-3
    torques = fit.system.y + fit.system.carried
    missed = np.linalg.norm(fit.system.y - fit.system.X[:, : len(arm.base)] @ arm.base) / np.linalg.norm(torques)
    assert file_share(fit.system, arm.base) == pytest.approx(missed)


def test_the_torques_of_a_payload_are_those_of_a_point_mass_on_the_last_link():
    arm, (rows,) = logs_of("macro", np.ones(3), (PAYLOAD,))
    motion, model = rows.motion, arm.model
    pin_model, data = model.separate()
    for row in (100, 900):
        q, dq, ddq = motion.q[row], motion.dq[row], motion.ddq[row]
        pin.forwardKinematics(pin_model, data, q, dq, ddq)
        placement = pin.updateFramePlacement(pin_model, data, model.tip_frame)
        J = pin.computeFrameJacobian(pin_model, data, q, model.tip_frame, pin.LOCAL_WORLD_ALIGNED)
        r = placement.rotation @ np.array(PAYLOAD.position)
        spin = pin.getFrameVelocity(pin_model, data, model.tip_frame, pin.LOCAL_WORLD_ALIGNED).angular
        tip = pin.getFrameClassicalAcceleration(pin_model, data, model.tip_frame, pin.LOCAL_WORLD_ALIGNED)
        acceleration = tip.linear + np.cross(tip.angular, r) + np.cross(spin, np.cross(spin, r))
        force = PAYLOAD.mass * (acceleration - pin_model.gravity.linear)
        expected = J[:3].T @ force + J[3:].T @ np.cross(r, force)
        np.testing.assert_allclose(payload_torques(motion, PAYLOAD)[row], expected, atol=1e-9)
