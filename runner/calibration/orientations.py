"""Optimal tool orientations for gravity calibration."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.sensing.wrench import cross_matrix

MAX_CONDITION_NUMBER = 100.0
"""Of either step's matrix; beyond it, noise enters the worst-known parameters a hundred times as much as the best."""


def force_matrix(orientations: FloatArray) -> FloatArray:
    """Return the factor of (G cos theta, G sin theta, G, F_x0, F_y0, F_z0) in the readings' forces, shape (3 N, 6).

    With rho the third row of 0R6, the vertical in the flange's frame:
    rows (-rho_x, -rho_y, 0, 1, 0, 0), (-rho_y, rho_x, 0, 0, 1, 0), (0, 0, -rho_z, 0, 0, 1).

    Args:
        orientations: 0R6, flange in the base frame, shape (N, 3, 3).
    """
    x, y, z = orientations[:, 2].T
    matrix = np.zeros((len(orientations), 3, 6))
    matrix[:, 0, 0], matrix[:, 0, 1] = -x, -y
    matrix[:, 1, 0], matrix[:, 1, 1] = -y, x
    matrix[:, 2, 2] = -z
    matrix[:, :, 3:] = np.eye(3)
    return matrix.reshape(-1, 6)


def moment_matrix(forces: FloatArray) -> FloatArray:
    """Return the factor of (r, k) in the readings' moments, M = -[F]_x r + k, shape (3 N, 6).

    Args:
        forces: Forces read, shape (N, 3), in N.
    """
    blocks = [np.hstack([-cross_matrix(force), np.eye(3)]) for force in forces]
    return np.vstack(blocks)


def condition_numbers(orientations: FloatArray) -> tuple[float, float]:
    """Return the condition numbers of the force and the moment matrix for a tool of 1 N on a sensor without bias.

    They depend only on the orientations. They are 1.73 and 1.22 if the vertical is spread evenly in the flange's frame.
    """
    matrices = force_matrix(orientations), moment_matrix(-orientations[:, 2])
    force, moment = (float(np.linalg.cond(matrix)) for matrix in matrices)
    return force, moment


def check_orientations(orientations: FloatArray) -> tuple[float, float]:
    """Return the condition numbers of orientations that differ enough.

    Raises:
        ConfigError: if they are too few or too much alike; names the condition numbers.
    """
    if len(orientations) < 3:
        raise ConfigError(f"calibration.orientations: {len(orientations)}; weighing a tool needs 3 or more")
    force, moment = condition_numbers(orientations)
    if max(force, moment) <= MAX_CONDITION_NUMBER:
        return force, moment
    spread = np.degrees(np.arccos(np.clip(orientations[:, 2] @ orientations[0, 2], -1.0, 1.0)).max())
    raise ConfigError(
        f"calibration.orientations: condition numbers {force:.3g} (force) and {moment:.3g} (moment); allowed: "
        f"up to {MAX_CONDITION_NUMBER:g}. Gravity turns by {spread:.3g} deg in the flange's frame; it must come "
        f"from directions that share no cone about the flange's z axis"
    )


def choose_orientations(candidates: FloatArray, count: int) -> list[int]:
    """Return the indices of the orientations that weigh a tool best, by determinant (D-optimal, greedy).

    Both steps depend on an orientation only by the vertical in the flange's frame, rho, and a constant. Each choice
    adds most to the determinant of the sum of (1, rho)(1, rho)'.

    Args:
        candidates: Orientations that the arm can take, flange in the base frame, shape (N, 3, 3).
        count: How many are wanted.

    Raises:
        ConfigError: if there are fewer candidates.
    """
    if count > len(candidates):
        raise ConfigError(
            f"calibration.orientations: {count} wanted of {len(candidates)} candidates; offer more, or take fewer"
        )
    rows = np.hstack([np.ones((len(candidates), 1)), candidates[:, 2]])
    information = 1e-6 * np.eye(4)
    chosen: list[int] = []
    for _ in range(count):
        gain = np.einsum("ij,ij->i", rows, np.linalg.solve(information, rows.T).T)
        gain[chosen] = -np.inf
        chosen.append(int(np.argmax(gain)))
        information += np.outer(rows[chosen[-1]], rows[chosen[-1]])
    return chosen
