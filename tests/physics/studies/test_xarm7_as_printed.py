"""The xArm7 report's second part, as printed."""

import numpy as np
import pytest

from runner.papers.studies.xarm7.parts.xarm7_as_printed import PrintedJacobian

POSTURES = np.random.default_rng(7).uniform(-1.5, 1.5, (50, 7))


def test_without_its_errors_it_is_the_true_jacobian(xarm7):
    jacobian = PrintedJacobian(xarm7.model, columns=False, angles=False)
    for q in POSTURES:
        np.testing.assert_allclose(jacobian(q), xarm7.model.tip_jacobian(q), atol=1e-14)


def test_as_printed_column_k_is_the_true_column_before(xarm7):
    jacobian = PrintedJacobian(xarm7.model, columns=True, angles=False)
    for q in POSTURES:
        true = xarm7.model.tip_jacobian(q)
        np.testing.assert_allclose(jacobian(q), true[:, [0, 0, 1, 2, 3, 4, 5]], atol=1e-14)


def test_entries_printed_in_full_are_these(xarm7):
    """J13, J43 and J53 of the report, with its l4 cos(q1), l4 sin(q1), l5 cos(q5) and l5 sin(q2)."""
    jacobian = PrintedJacobian(xarm7.model, columns=True, angles=True)
    l2, l3, l4, l5 = 0.293, 0.0525, float(np.hypot(0.0775, 0.3425)), float(np.hypot(0.076, 0.097))
    for q in POSTURES:
        (s1, s2, s3, s4, s5, s6), (c1, c2, c3, c4, c5, c6) = np.sin(q[:6]), np.cos(q[:6])
        along, across = c2 * c4 + c3 * s2 * s4, c2 * s4 - c3 * c4 * s2
        J13 = c1 * (
            l2 * c2
            - l4 * c1 * along
            + l4 * s1 * across
            - l3 * c3 * s2
            - l5 * c5 * (s6 * (c5 * across - s2 * s3 * s5) + c6 * along)
            + l5 * s2 * (c6 * (c5 * across - s2 * s3 * s5) - s6 * along)
        )
        J = jacobian(q)
        np.testing.assert_allclose([J[0, 2], J[3, 2], J[4, 2]], [J13, -s1, c1], atol=1e-14)


@pytest.mark.parametrize("rows", [3, 6])
def test_what_the_report_inverts_has_no_inverse(xarm7, rows):
    for q in POSTURES:
        J = xarm7.model.tip_jacobian(q)[:rows]
        assert np.linalg.matrix_rank(J.T @ J) == rows


def test_with_every_error_put_right_it_follows_the_line(simulated):
    right = ("controller.columns=right", "controller.angles=right", "controller.inverse=right")
    trace = simulated("robot=xarm7", "controller=xarm7_as_printed", *right, "controller.gain=20")
    assert np.abs(trace.error).max() < 1e-4


@pytest.mark.parametrize("error", ["columns", "angles", "inverse"])
def test_each_error_alone_spoils_the_motion(simulated, error):
    right = [f"controller.{key}=right" for key in ("columns", "angles", "inverse") if key != error]
    trace = simulated("robot=xarm7", "controller=xarm7_as_printed", *right)
    assert trace.failure is not None or np.abs(trace.error).max() > 5e-3
