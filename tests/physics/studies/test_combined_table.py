"""Denavit-Hartenberg table of the combined arm against the thesis and the model's tip pose."""

import numpy as np
import pytest
from support.arms import checked

from runner.papers.studies.thesis.denavit_hartenberg import denavit_hartenberg, frames

# The thesis' table 5.1 is lost; this is what its appendix was derived with.
THETA = np.radians([90.0, 0.0, 180.0, 180.0, 0.0, 90.0])
D = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
A = [0.0, 1.0, 0.0, 0.0, 0.1, 0.1]
ALPHA = np.radians([90.0, 0.0, 90.0, 90.0, 0.0, 90.0])


@pytest.fixture(scope="module")
def model():
    return checked("robot=combined").arm.model


def test_table_5_1_is_reproduced(model):
    rows = denavit_hartenberg(model)
    for name, expected in (("theta", THETA), ("d", D), ("a", A), ("alpha", ALPHA)):
        np.testing.assert_allclose([getattr(row, name) for row in rows], expected, rtol=0, atol=1e-14)


def test_half_turns_have_one_sign_whatever_rounding_does(model):
    rows = denavit_hartenberg(model)
    assert all(angle > -np.pi + 1e-6 for row in rows for angle in (row.theta, row.alpha))


def test_the_product_is_the_tip_pose(model):
    rows = denavit_hartenberg(model)
    for q in np.random.default_rng(0).uniform(-np.pi, np.pi, (200, 6)):
        np.testing.assert_allclose(frames(rows, q)[-1], model.tip_pose(q), atol=1e-12)


def test_check_values_of_the_appendix(model):
    q = np.array([0.3, -0.5, 0.7, 0.2, -0.4, 0.9])
    dq, ddq = np.arange(1, 7) / 10.0, np.arange(6, 0, -1) / 10.0
    tau = model.mass_matrix(q) @ ddq + model.coriolis_torque(q, dq) + model.gravity_torque(q)
    np.testing.assert_allclose(tau, [0.756871, 17.639557, -1.458317, 0.001641, 0.132384, -0.057832], atol=1e-6)
    np.testing.assert_allclose(frames(denavit_hartenberg(model), q)[-1, :3, 3], [-0.218685, 0.677258, 0.557083],
                               atol=1e-6)  # fmt: skip
