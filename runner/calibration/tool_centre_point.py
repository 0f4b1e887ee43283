"""Tool centre point from poses with the tip on one fixed point (Meca500 report, section 2), and its procedure."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.calibration.procedure import Bench, Outcome, TouchingConfig, touching_postures
from runner.sensing.wrench import cross_matrix

MIN_SINGULAR_VALUE = 0.01
"""Per pose; below it, an error of the poses becomes more than a hundred times as large at the tip."""


@dataclass(frozen=True)
class ToolCentrePoint:
    """An identified tool centre point.

    Attributes:
        position: The tip in the flange's frame, shape (3,), in m.
        covariance: Covariance of its error, shape (3, 3), in m^2.
        condition_number: Ratio of the largest to the smallest singular value of the stacked rotation differences.
        smallest_singular_value: The smallest of them, over the square root of their number.
        residual: Root mean square of the distance by which the poses miss one point, in m.
    """

    position: FloatArray
    covariance: FloatArray
    condition_number: float
    smallest_singular_value: float
    residual: float


def identify_tool_centre_point(poses: FloatArray, pose_covariances: FloatArray) -> ToolCentrePoint:
    r"""Return the tool centre point by the four-point method, for any number of poses from three on.

    Pose 1 is subtracted from each other pose (report eqs. 4, 5), and the stack solved by least squares:

    .. math:: (R_1 - R_k) p = P_k - P_1, \qquad k = 2 \dots N

    Pose 1 is in every row, so that the rows' errors are not independent. With A the stack, B the differences of
    the tips and S the tips' covariances, block by block, the covariance is

    .. math:: A^+ B S B^T A^{+T}, \qquad S_k = J_k \Sigma_k J_k^T, \quad J_k = [1, -[R_k p]_\times]

    Args:
        poses: Flange in the base frame, shape (N, 4, 4), with the tip at the same point in each.
        pose_covariances: Covariance of each pose's error in the base frame, position in m and rotation vector in rad,
            shape (N, 6, 6).

    Raises:
        ConfigError: if the poses are too few, too much alike, or turned about parallel axes only.
    """
    R, P = poses[:, :3, :3], poses[:, :3, 3]
    if len(poses) < 3:
        raise ConfigError(f"calibration.poses: {len(poses)} poses; a tool centre point needs 3 or more")
    A = (R[0] - R[1:]).reshape(-1, 3)
    rows = len(poses) - 1
    singular_values = np.linalg.svd(A, compute_uv=False)
    smallest = float(singular_values[-1]) / np.sqrt(rows)
    if smallest < MIN_SINGULAR_VALUE:
        raise ConfigError(_refusal(R, singular_values, smallest))
    inverse = np.linalg.pinv(A)
    b = (P[1:] - P[0]).reshape(-1)
    p = inverse @ b
    blocks = inverse.reshape(3, rows, 3).transpose(1, 0, 2)
    blocks = np.concatenate([-blocks.sum(axis=0)[None], blocks])  # A+ B: how each pose's tip error enters
    covariance = np.zeros((3, 3))
    for block, rotation, pose_covariance in zip(blocks, R, pose_covariances, strict=True):
        gain = block @ np.hstack([np.eye(3), -cross_matrix(rotation @ p)])
        covariance += gain @ pose_covariance @ gain.T
    tips = R @ p + P
    return ToolCentrePoint(
        position=p,
        covariance=covariance,
        condition_number=float(singular_values[0] / singular_values[-1]),
        smallest_singular_value=smallest,
        residual=float(np.sqrt(np.mean(np.sum((tips - tips.mean(axis=0)) ** 2, axis=1)))),
    )


def _refusal(R: FloatArray, singular_values: FloatArray, smallest: float) -> str:
    turns = np.array([pin.log3(R[0].T @ other) for other in R[1:]])
    angles = np.linalg.norm(turns, axis=1)
    condition = singular_values[0] / singular_values[-1] if singular_values[-1] > 0.0 else np.inf
    found = f"smallest singular value {smallest:.3g}, condition number {condition:.3g}"
    if angles.max() < 10.0 * MIN_SINGULAR_VALUE:
        why = f"the poses are too much alike: none is turned by more than {np.degrees(angles.max()):.3g} deg"
    else:
        axis = np.round(turns[np.argmax(angles)] / angles.max(), 3) + 0.0  # which makes -0 plain 0
        why = (
            f"all poses are turned about parallel axes, {axis.tolist()} in the flange's frame, along "
            f"which the tip stays unknown"
        )
    return (
        f"calibration.poses: {why} ({found}); allowed: {MIN_SINGULAR_VALUE:g} or more. Turn the flange about two axes "
        f"that are not parallel, by 30 deg or more"
    )


class TouchedPointConfig(TouchingConfig):
    """Config of the procedure.

    Attributes:
        kind: Its name in the registry.
    """

    kind: Literal["tool_centre_point"]


class TouchedPoint:
    """The procedure; its measures are the condition of the poses, and their distance from one point.

    Args:
        config: The poses.
        bench: The arm.
    """

    estimates: ClassVar[Mapping[str, str]] = {"x": "m", "y": "m", "z": "m"}
    errors: ClassVar[Mapping[str, str]] = estimates
    measures: ClassVar[Mapping[str, str]] = {"condition_number": "1", "smallest_singular_value": "1", "residual": "m"}

    def __init__(self, config: TouchedPointConfig, bench: Bench) -> None:
        self.truth = bench.tip
        self.postures = touching_postures(bench, bench.tip, config)
        self._bench, self._repeatability = bench, config.repeatability

    def repeat(self, generator: np.random.Generator) -> Outcome:
        """Calibrate once; see Procedure."""
        found = identify_tool_centre_point(*self._bench.read_poses(self.postures, self._repeatability, generator))
        measures = {name: float(getattr(found, name)) for name in self.measures}
        return Outcome(found.position, found.position - self.truth, found.covariance, measures)


CONFIG = TouchedPointConfig
build = TouchedPoint
