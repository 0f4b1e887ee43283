r"""Combination of identified values with the values of the robot's file, each with a width that the user gives.

.. math:: \hat\pi = (G^T V^{-1} G + P^{-1})^{-1} (G^T V^{-1} \hat\theta + P^{-1} \pi_0)

The logs give the sums theta = G pi with a covariance V, and the file gives pi_0 with P. The share of the prior in a
value is the diagonal element of the second term's factor: 1 if the logs do not tell the value, 0 if only they do.
"""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.identification.fit import Fit

_UNKNOWN = 1e3  # kg m^2 or kg: of a rotor whose inertia the file lacks


@dataclass(frozen=True)
class WithPrior:
    """Values of all columns with a prior for the sums of inertial parameters.

    Attributes:
        values: Shape (n,); zero for friction that the logs do not tell.
        halves: Half-widths of the 95 % intervals, shape (n,).
        shares: Share of the prior in each value, shape (n,); NaN for friction, which has none.
    """

    values: FloatArray
    halves: FloatArray
    shares: FloatArray


def prior_widths(full: FloatArray, links: int, width: float) -> FloatArray:
    """Return standard deviations of the parameters of a file, shape (10 links + rotors,).

    They are a share of the mass m, of m r and of m r^2, where r is the radius of gyration about the frame's origin: a
    coordinate of zero is not exact. A rotor's is a share of its inertia.

    Args:
        full: Inertial parameters and rotor inertias of the file, shape (10 links + rotors,).
        links: Number of links.
        width: The share.
    """
    bodies, rotors = full[: 10 * links].reshape(links, 10), full[10 * links :]
    m = np.maximum(bodies[:, 0], 1e-6)
    square = np.maximum(0.5 * bodies[:, [4, 6, 9]].sum(axis=1), 1e-9 * m)  # m r^2
    widths = np.column_stack([m, *3 * [np.sqrt(m * square)], *6 * [square]])
    return np.concatenate([width * widths.ravel(), np.where(rotors > 0.0, width * rotors, _UNKNOWN)])


def combine_with_prior(fit: Fit, halves: FloatArray, base: FloatArray, covariance: FloatArray) -> WithPrior:
    """Return the values of a fit and of a file, combined.

    Args:
        fit: The fit.
        halves: Half-widths of its 95 % intervals, shape (n,); NaN for what is not known.
        base: Sums of inertial parameters of the file, shape (number of sums,).
        covariance: Their covariance, shape (number of sums, number of sums).
    """
    layout, nb = fit.state.layout, fit.state.layout.base
    known = [place for place, column in enumerate(fit.taken) if column != layout.delay and np.isfinite(halves[column])]
    told = [fit.taken[place] for place in known]
    friction = [column for column in told if column >= nb]
    columns = [*range(nb), *friction]
    G = fit.factors[np.ix_(known, columns)]
    deviations = halves[told] / 1.96
    inverse = np.linalg.inv(_correlation(fit)[np.ix_(known, known)]) / np.outer(deviations, deviations)
    scale = np.sqrt(np.diagonal(covariance))
    sure = np.linalg.inv(covariance / np.outer(scale, scale)) / np.outer(scale, scale)
    sizes = np.concatenate([scale, halves[friction]])
    of_prior = np.zeros((len(columns), len(columns)))
    of_prior[:nb, :nb] = sure
    whole = (G.T @ inverse @ G + of_prior) * np.outer(sizes, sizes)
    posterior = np.linalg.inv(whole) * np.outer(sizes, sizes)
    right = G.T @ inverse @ fit.state.values[told]
    right[:nb] += sure @ base
    values, own, shares = (np.full(layout.delay + 1, empty) for empty in (0.0, np.nan, np.nan))
    values[columns] = posterior @ right
    own[columns] = 1.96 * np.sqrt(np.diagonal(posterior))
    shares[:nb] = np.clip(np.diagonal(posterior @ of_prior)[:nb], 0.0, 1.0)
    return WithPrior(values, own, shares)


def _correlation(fit: Fit) -> FloatArray:
    """Return the correlation of the taken values for white residuals: blocks are too few for one of their own."""
    used = fit.weights > 0.0
    X = fit.system.X[used][:, fit.taken] * fit.weights[used, None]
    X = X / np.linalg.norm(X, axis=0)
    covariance = np.linalg.inv(X.T @ X)
    size = np.sqrt(np.diagonal(covariance))
    return np.asarray(covariance / np.outer(size, size))
