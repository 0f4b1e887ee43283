"""Sliding-mode control of the joints: its equation, its layer, how fast it is reached, and chatter."""

import numpy as np
import pinocchio as pin
import pytest
from support.arms import checked

from runner.plants.rk4 import Rk4

OMEGA, PHI = 30.0, 0.05
LINE = ("robot=macro", "controller=sliding_mode", "controller.period=0.001", f"controller.natural_frequency={OMEGA}",
        f"controller.boundary_layer={PHI}", "plant=rk4")  # fmt: skip


def configured(*overrides):
    return checked(*LINE, "trajectory=joint_quintic", *overrides)


def sliding(trace, config):
    """s at every tick, and the errors of the joints."""
    q_d, dq_d, _ = np.moveaxis(config.path.sample_joints(trace.t), 1, 0)
    return dq_d - trace.dq + OMEGA * (q_d - trace.q), q_d - trace.q


@pytest.mark.parametrize("name", ["macro", "xarm7"])
@pytest.mark.parametrize("kappa", [1.0, 2.0])
def test_torques_are_those_of_the_equation(name, kappa):
    config = configured(f"robot={name}", f"controller.switching_gain={kappa}")
    arm, generator = config.arm, np.random.default_rng(5)
    n, model, pin_model = arm.model.nq, arm.model, arm.model.pin_model
    D = model.mass_matrix(arm.home).diagonal()
    for size in (1e-3, 1.0):  # within the layer, and beyond
        q, dq, e, de = arm.home + generator.normal(size=n), *generator.normal(size=(3, n)) * [[1.0], [size], [size]]
        ddq_d = generator.normal(size=n)
        dq_r, ddq_r, s = dq + de + OMEGA * e, ddq_d + OMEGA * de, de + OMEGA * e
        C = pin.computeCoriolisMatrix(pin_model, pin_model.createData(), q, dq)
        expected = model.mass_matrix(q) @ ddq_r + C @ dq_r + model.gravity_torque(q)
        expected += OMEGA * D * (s + kappa * PHI * np.clip(s / PHI, -1.0, 1.0))
        torque = config.loops[0].controller.torque(0.0, q, dq, np.array([q + e, dq + de, ddq_d]))
        np.testing.assert_allclose(torque, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


def test_the_error_stays_within_the_bound_of_the_layer(simulated):
    """|d| < K + phi K_D joint by joint, so that |s| < phi and |e| < phi / lambda, through a whole motion."""
    wrong = ("mismatch.mass=0.95", "plant.friction.coulomb=1.5", "duration=4")
    config = configured(*wrong)
    trace = simulated(*LINE, "trajectory=joint_quintic", *wrong)
    s, e = sliding(trace, config)
    law, model = config.loops[0].controller.parameters.own, config.arm.model
    left_out = 0.05 * np.abs([model.gravity_torque(q) for q in trace.q]).max(axis=0) + 1.5
    assert (left_out < law.switching_gain + PHI * law.damping).all()  # what moves adds less than what is left here
    assert 0.3 * PHI < np.abs(s).max() < PHI
    assert np.abs(e).max() < PHI / OMEGA


def test_the_layer_is_reached_in_time():
    """From a state far outside, under an exact model: d/dt sqrt(s M s) <= -min K / sqrt(max eig M)."""
    config = configured()
    arm, law, h = config.arm, config.loops[0].controller, 1e-4
    plant, goal = Rk4(arm.model, h, 1), np.array([arm.home, np.zeros(3), np.zeros(3)])
    plant.reset(arm.home, np.array([0.6, -0.8, 1.0]))
    law.reset()
    rows = []
    for tick in range(3000):
        M = arm.model.mass_matrix(plant.q)
        rows.append((-plant.dq + OMEGA * (arm.home - plant.q), M))
        plant.advance(law.torque(h * tick, plant.q, plant.dq, goal))
    energy = np.sqrt([s @ M @ s for s, M in rows])
    smallest, largest = (pick([np.linalg.eigvalsh(M) for _, M in rows]) for pick in (np.min, np.max))
    fastest = law.parameters.own.switching_gain.min() / np.sqrt(largest)
    outside = energy > np.sqrt(smallest) * PHI
    assert outside[0]
    assert not outside[-1]
    assert h * np.flatnonzero(outside)[-1] < energy[0] / fastest
    assert max(np.abs(s).max() for (s, _), out in zip(rows, outside, strict=True) if not out) <= PHI


def test_a_thin_layer_makes_the_torques_of_noisy_encoders_rough(simulated):
    def roughness(layer, *more):
        run = simulated(*LINE, "trajectory=joint_quintic", f"controller.boundary_layer={layer}", "noise.position=1e-4",
                        "noise.distribution=gaussian", "duration=0.5", *more)  # fmt: skip
        return np.abs(np.diff(run.tau[:-1], axis=0)).mean()

    # Within the layer the gain of s is K_D + K / phi: K at phi 0.05, in a layer of a tenth.
    rough, smooth = roughness(0.005, "controller.switching_gain=10"), roughness(0.05)
    assert rough > 3.0 * smooth
