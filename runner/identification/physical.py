"""Physical consistency of identified values: whether bodies with positive masses and inertias have them.

The pseudo-inertia of a body is positive semidefinite. It is a product L L^T here (Rucker and Wensing, IEEE Robotics and
Automation Letters 7(2), 2022), and least squares finds the bodies nearest to the values.
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from runner.base.arrays import FloatArray

_LOWER = np.tril_indices(4)
_STEPS = 200
_LEAST = 1e-6  # kg and kg m^2, of the bodies at which the search begins


def nearest_bodies(
    factors: FloatArray, values: FloatArray, halves: FloatArray, start: FloatArray, links: int
) -> FloatArray:
    """Return by how many half-widths the nearest set of possible bodies misses each value, shape (n,).

    Args:
        factors: Factors of all inertial parameters in each value, shape (n, 10 links + rotors); see parameter_names.
        values: The values, shape (n,).
        halves: Half-widths of their intervals, shape (n,).
        start: Parameters of the bodies at which the search begins, shape (10 links + rotors,).
        links: Number of links.
    """
    scale = factors / halves[:, None]
    wanted = values / halves

    def bodies(roots: FloatArray) -> FloatArray:
        lower = np.zeros((links, 4, 4))
        lower[:, _LOWER[0], _LOWER[1]] = roots[: 10 * links].reshape(links, 10)
        return np.concatenate([_parameters(lower @ lower.transpose(0, 2, 1)).ravel(), roots[10 * links :] ** 2])

    def misses(roots: FloatArray) -> FloatArray:
        return np.asarray(scale @ bodies(roots) - wanted)

    def slopes(roots: FloatArray) -> FloatArray:
        lower = np.zeros((links, 4, 4))
        lower[:, _LOWER[0], _LOWER[1]] = roots[: 10 * links].reshape(links, 10)
        jacobian = np.zeros((len(start), len(roots)))
        for number, (row, column) in enumerate(zip(*_LOWER, strict=True)):
            unit = np.zeros((4, 4))
            unit[row, column] = 1.0
            product = lower @ unit.T
            change = _parameters(product + product.transpose(0, 2, 1))
            for link in range(links):
                jacobian[10 * link : 10 * link + 10, 10 * link + number] = change[link]
        rotors = np.arange(10 * links, len(start))
        jacobian[rotors, rotors] = 2.0 * roots[rotors]
        return np.asarray(scale @ jacobian)

    found = least_squares(misses, _roots(start, links), slopes, x_scale="jac", max_nfev=_STEPS)
    return np.asarray(found.fun)


def describe_bodies(names: Sequence[str], misses: FloatArray) -> str:
    """Return a sentence on the misses of the nearest possible bodies."""
    worst = int(np.argmax(np.abs(misses)))
    if abs(misses[worst]) <= 1.0:
        return (
            "Bodies with positive masses and inertias have these values, within all intervals; the fit did not enforce "
            "it."
        )
    outside = int(np.sum(np.abs(misses) > 1.0))
    return (
        f"No bodies with positive masses and inertias were found with these values: the nearest ones lie outside "
        f"{outside} of {len(misses)} intervals, at most {abs(misses[worst]):.2g} half-widths from {names[worst]}. The "
        "fit did not enforce it."
    )


def _parameters(pseudo: FloatArray) -> FloatArray:
    """Return the parameters of bodies in the order of Pinocchio, shapes (links, 4, 4) to (links, 10)."""
    second = pseudo[:, :3, :3]
    inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    parts = [pseudo[:, 3, 3], *pseudo[:, :3, 3].T]
    parts += [inertia[:, row, column] for row, column in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
    return np.stack(parts, axis=1)


def _roots(start: FloatArray, links: int) -> FloatArray:
    """Return the roots of the bodies of a file, made possible where they are not."""
    found = []
    for m, x, y, z, *inertia in start[: 10 * links].reshape(links, 10):
        xx, xy, yy, xz, yz, zz = inertia
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        pseudo = np.zeros((4, 4))
        pseudo[:3, :3] = 0.5 * np.trace(tensor) * np.eye(3) - tensor
        pseudo[3, :3] = pseudo[:3, 3] = x, y, z
        pseudo[3, 3] = m
        sizes, vectors = np.linalg.eigh(pseudo)
        root = np.linalg.qr((vectors * np.sqrt(np.maximum(sizes, _LEAST))).T)[1].T
        found.append(root[_LOWER])
    return np.concatenate([*found, np.sqrt(np.maximum(start[10 * links :], _LEAST))])
