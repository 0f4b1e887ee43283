"""Named assertions about laws and motions, each with the tolerance that its physics gives it.

A tolerance is relative to the size of the compared values, so one number serves arms of a metre and of a decimetre.
Algebra of a handful of 6 x 6 matrices leaves about 1e-12 of it, differences of step 1e-6 about 1e-6.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from runner.base.trace import Trace

FloatArray = NDArray[np.float64]


def torque_of(controller, q, dq, reference, time: float = 0.0) -> FloatArray:
    """Return a copy of the torques that a law asks for; its next call does not change it."""
    return controller.torque(time, np.array(q), np.array(dq), np.array(reference)).copy()


def assert_agree(actual: ArrayLike, expected: ArrayLike, share: float, of: ArrayLike | None = None, why="") -> None:
    """Assert that arrays agree, relative to the largest entry.

    Args:
        actual: What was found.
        expected: What it has to be, of the same shape.
        share: What may be left, relative to the largest entry.
        of: The array whose largest entry counts; `expected` if it is left out. Give the summands where the
            expected values are a small difference of large ones.
        why: What the message begins with.
    """
    size = np.abs(expected if of is None else of).max()
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=share * size, err_msg=why)


def assert_order(errors: Sequence[float], order: float, within: float) -> None:
    """Assert that errors fall with a power of a step that halves from each to the next.

    Args:
        errors: Largest errors, the one of the largest step first.
        order: The power.
        within: How far the order that is found may be off: the next term of the error's series, of relative size
            h, is log2(1 + h/2) of it.
    """
    found = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(found, order, rtol=0.0, atol=within)


def assert_energy_kept(energies: ArrayLike, share: float) -> None:
    """Assert that a motion without losses keeps its energy, relative to the first value."""
    energies = np.asarray(energies)
    np.testing.assert_allclose(energies, energies[0], rtol=0.0, atol=share * abs(energies[0]))


def assert_passive(energies: ArrayLike, rounding: float) -> None:
    """Assert that a motion never gains energy and loses some; `rounding` is in J."""
    changes = np.diff(np.asarray(energies))
    assert changes.max() <= rounding
    assert changes.sum() < -rounding


def linear_design(reference: FloatArray, x: FloatArray, dx: FloatArray, omega: float, xi: float) -> FloatArray:
    r"""Return the acceleration that a law of linear design asks for (thesis eq. 3.34).

    .. math:: F^* = \ddot x_d + 2 \xi \omega_n (\dot x_d - \dot x) + \omega_n^2 (x_d - x)

    Args:
        reference: Desired position, velocity and acceleration, shape (3, n).
        x: Position, shape (n,).
        dx: Velocity, shape (n,).
        omega: omega_n, in rad/s.
        xi: Damping ratio.
    """
    x_d, dx_d, ddx_d = reference
    return ddx_d + 2.0 * xi * omega * (dx_d - dx) + omega**2 * (x_d - x)


def assert_linear_design(acceleration, reference, x, dx, omega, xi, share=1e-9) -> None:
    """Assert that an acceleration is that of the linear design; `share` is of its largest component."""
    assert_agree(acceleration, linear_design(reference, x, dx, omega, xi), share)


def critically_damped(t: ArrayLike, omega: float) -> FloatArray:
    """Return the rest of a unit step after times t, in s, of a critically damped mode from rest."""
    return (1.0 + omega * np.asarray(t)) * np.exp(-omega * np.asarray(t))


def assert_same_motion(ours: Trace, theirs: Trace, posture: float = 1e-11, torque: float = 1e-9) -> None:
    """Assert that two evaluations of one law give one motion.

    Args:
        ours: A trace.
        theirs: The other one, of the same ticks.
        posture: Largest difference of joints and end points, in rad or m: roundings of 1e-16, grown along the run.
        torque: Largest difference of torques relative to the largest torque: that of postures times the stiffness of
            the law.
    """
    assert ours.failure is theirs.failure is None
    np.testing.assert_array_equal(ours.t, theirs.t)
    np.testing.assert_array_equal(ours.desired, theirs.desired)
    np.testing.assert_allclose(ours.q, theirs.q, rtol=0.0, atol=posture)
    np.testing.assert_allclose(ours.end_points, theirs.end_points, rtol=0.0, atol=posture)
    assert_agree(ours.tau, theirs.tau, torque)
