"""Tool centre point calibration at one fixed point (section 2 of the report), compared with the true point."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.calibration.tool_centre_point import identify_tool_centre_point
from runner.calibration.uncertainty import consistency, joint_deviation, pose_covariances
from runner.papers.studies.meca500.figures import Calibrations, flange_of
from runner.papers.study.measured import Measured
from runner.sensing.wrench import cross_matrix
from runner.store import Calibration


def deviation(done: Calibration) -> float:
    """Return the standard deviation of each joint, in rad."""
    home = np.array(done.config["robot"]["home"])[None]
    return joint_deviation(flange_of(done), home, done.config["calibration"]["repeatability"])


def shared_pose(calibrations: Calibrations, name: str) -> dict[str, Measured]:
    """Return predicted errors: with rows taken as independent, with pose 1 shared, and with no pose singled out."""
    done = calibrations[name]
    model = flange_of(done)
    poses = np.array([model.tip_pose(q) for q in done.postures])
    covariances = pose_covariances(model, done.postures, deviation(done))
    tips = tip_covariances(poses, covariances, np.array(done.config["robot"]["tool"]["tip"]))
    wrong, errors = independent_rows_covariance(poses, tips), done.values("errors")
    judged = consistency(errors, np.repeat(wrong[None], len(errors), axis=0), 0.99)
    covariance_of = {
        "wrong": ("with rows taken as independent", wrong),
        "right": ("with pose 1 shared", identify_tool_centre_point(poses, covariances).covariance),
        "together": ("with no pose singled out", common_point_covariance(poses, tips)),
    }
    return {
        key: Measured(f"predicted error {title}", 1e6 * float(np.sqrt(np.trace(covariance))), "µm")
        for key, (title, covariance) in covariance_of.items()
    } | {
        "errors": Measured("errors", len(errors)),
        "nees": Measured("NEES with rows taken as independent", float(judged.mean)),
        "lower": Measured("lower end of its band", float(judged.lower)),
        "upper": Measured("upper end of its band", float(judged.upper)),
    }


def tip_covariances(poses: FloatArray, covariances: FloatArray, tip: FloatArray) -> FloatArray:
    """Return the covariance of the tip's position, from that of each pose of the flange, shape (N, 3, 3), in m^2."""
    levers = np.array([np.hstack([np.eye(3), -cross_matrix(pose[:3, :3] @ tip)]) for pose in poses])
    return np.asarray(levers @ covariances @ levers.transpose(0, 2, 1))


def independent_rows_covariance(poses: FloatArray, tips: FloatArray) -> FloatArray:
    """Return sigma^2 (A'A)^-1, shape (3, 3), in m^2, with sigma^2 twice the mean variance of a tip's coordinate.

    `poses` and `tips` are what tip_covariances takes and gives.
    """
    A = (poses[0, :3, :3] - poses[1:, :3, :3]).reshape(-1, 3)
    return np.asarray(2.0 * np.einsum("kii->", tips) / (3.0 * len(tips)) * np.linalg.inv(A.T @ A))


def common_point_covariance(poses: FloatArray, tips: FloatArray) -> FloatArray:
    """Return the covariance of p where R_k p - c = -P_k is solved for p and c, shape (3, 3), in m^2."""
    A = np.vstack([np.hstack([pose[:3, :3], -np.eye(3)]) for pose in poses])
    blocks = np.linalg.pinv(A)[:3].reshape(3, len(poses), 3).transpose(1, 0, 2)
    return np.asarray(np.sum(blocks @ tips @ blocks.transpose(0, 2, 1), axis=0))
