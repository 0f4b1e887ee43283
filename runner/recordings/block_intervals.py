"""Covariance of a least-squares fit whose residuals are correlated within blocks of rows.

The rows of a block may be correlated in any way (Liang and Zeger, Biometrika 73(1), 1986). The residuals of a block are
made as large as they were before the fit took up its share (Bell and McCaffrey, Survey Methodology 28(2), 2002).
"""

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray


def block_scores(own: FloatArray, taken: FloatArray, rest: FloatArray, blocks: NDArray[np.intp]) -> FloatArray:
    """Return the contribution of each block to the normal equations, shape (number of blocks, n).

    Args:
        own: Columns of the fit, shape (N, n).
        taken: Orthonormal basis of all that the fit takes up, shape (N, m).
        rest: Residuals, shape (N,).
        blocks: Number of the block that each row is of, shape (N,).
    """
    numbers = np.unique(blocks)
    return np.array([own[rows].T @ _unshrunk(taken[rows], rest[rows]) for rows in map(blocks.__eq__, numbers)])


def _unshrunk(taken: FloatArray, rest: FloatArray) -> FloatArray:
    """Return the residuals of a block as large as they were before the fit took up its share."""
    values, vectors = np.linalg.eigh(np.eye(len(rest)) - taken @ taken.T)
    found: FloatArray = vectors @ (vectors.T @ rest / np.sqrt(np.maximum(values, 1e-6)))
    return found
