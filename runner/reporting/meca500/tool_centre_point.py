"""The tool centre point by touching one point (section 2 of the report), judged by the true one."""

import numpy as np
import pinocchio as pin

from runner.calibration import consistency, identify_tool_centre_point, joint_deviation, pose_covariances
from runner.reporting.document import Block, Curves, FloatArray, Formula, Notice, Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.meca500.calibration_plan import POSES, REPEATABILITIES, SPREADS, name_of
from runner.reporting.meca500.calibration_studies import (
    CONSISTENCY_HEADER,
    Calibrations,
    consistency_cells,
    consistency_notice,
    error_curves,
    fit,
    flange_of,
    found_error,
    metres,
    predicted_error,
    refusal,
)
from runner.reporting.quantities import number
from runner.store import Calibration

_KIND = "tool_centre_point"


def tool_centre_point_section(calibrations: Calibrations) -> Section:
    """Return errors over repeatability, number and spread of poses, conditioning, and what is refused."""
    base = calibrations[f"{_KIND}/base"]
    config = base.config["calibration"]
    blocks: list[Block] = [
        Text(
            f"The tool's tip touches one point with the flange in several poses. Here the true tip is known, "
            f"{base.config['robot']['tool']['tip']} m in the flange's frame. The arm stands exactly where the tip "
            "touches, and reports joint positions with errors of its repeatability: "
            f"{metres(config['repeatability'])} of the flange at home, which is {number(_deviation(base))} rad of "
            "each joint. Unless said otherwise the flange is "
            f"tilted by {number(float(np.degrees(config['spread'])), 2)}° about {config['poses']} axes all around it, "
            f"and the calibration repeated {base.record['repetitions']} times."
        ),
        Formula(
            "(R_1 - R_k) p = P_k - P_1, quad k = 2 ... N",
            "R 1 minus R k, times p, equals P k minus P 1, for k from 2 to N",
            "4, 5",
        ),
        Text(
            "Pose 1 stands in every row. With $A$ the stack of the left sides, $B$ the differences of the tips, and "
            "$S$ the covariances of the tips, which follow from the joints' by the Jacobian $J_k$ of the tip, the "
            "estimate's covariance is"
        ),
        Formula(
            "P = A^+ B S B^T (A^+)^T, quad S_k = sigma^2 J_k J_k^T",
            "P equals A plus B S B transposed A plus transposed, with S k equal sigma squared J k J k transposed",
        ),
        Table(
            "Found and predicted error of the tip (root mean square over the repetitions), by what is varied. NEES is "
            "the mean of $e^T P^(-1) e$, whose expectation is 3.",
            ["varied", "value", "error (µm)", "predicted (µm)", "condition", "smallest σ", *CONSISTENCY_HEADER],
            _rows(calibrations),
            (1, 2, 3, 4, 5, 6, 7),
            origin(base),
        ),
        _curves(calibrations),
        _finding(calibrations),
        consistency_notice(calibrations, _KIND),
        _shared_pose(calibrations[name_of(f"{_KIND}/poses", POSES[-1])]),
        _refused(base),
    ]
    return Section("Tool centre point", blocks)


def _deviation(calibration: Calibration) -> float:
    """Return the standard deviation of each joint, in rad."""
    home = np.array(calibration.config["robot"]["home"])[None]
    return joint_deviation(flange_of(calibration), home, calibration.config["calibration"]["repeatability"])


def _rows(calibrations: Calibrations) -> list[list[str]]:
    variations = (
        ("repeatability", "repeatability (µm)", REPEATABILITIES, 1e6),
        ("poses", "number of poses", POSES, 1.0),
        ("spread", "spread (deg)", SPREADS, np.degrees(1.0)),
    )
    rows = []
    for key, title, values, factor in variations:
        for value in values:
            done = calibrations[name_of(f"{_KIND}/{key}", value)]
            rows.append(
                [
                    title,
                    number(float(factor * value)),
                    number(1e6 * found_error(done)),
                    number(1e6 * predicted_error(done)),
                    number(done.summary("measures", "condition_number")["median"]),
                    number(done.summary("measures", "smallest_singular_value")["median"]),
                    *consistency_cells(done),
                ]
            )
    return rows


def _curves(calibrations: Calibrations) -> Curves:
    y_label = "error of the tip (m)"
    return Curves(
        "Error of the tool centre point over repeatability, number and spread of the poses.",
        (
            error_curves(calibrations, {f"{_KIND}/repeatability": REPEATABILITIES}, "repeatability (m)", y_label),
            error_curves(calibrations, {f"{_KIND}/poses": POSES}, "number of poses", y_label, log=False),
            error_curves(calibrations, {f"{_KIND}/spread": SPREADS}, "spread (rad)", y_label),
        ),
        3,
        origin(calibrations[f"{_KIND}/base"]),
    )


def _finding(calibrations: Calibrations) -> Notice:
    exact = calibrations[name_of(f"{_KIND}/repeatability", 0.0)]
    narrow, wide = (calibrations[name_of(f"{_KIND}/spread", value)] for value in (SPREADS[0], SPREADS[-1]))
    few, many = (calibrations[name_of(f"{_KIND}/poses", count)] for count in (4, POSES[-1]))
    spread_errors = [predicted_error(calibrations[name_of(f"{_KIND}/spread", value)]) for value in SPREADS]
    power = fit(np.array(SPREADS), np.array(spread_errors))
    worst = float(np.abs(exact.values("errors")).max())
    return Notice(
        "finding",
        "The spread of the poses counts, their number little",
        f"Without noise the tip is found within {number(worst)} m. Four poses err by {metres(found_error(wide))} when "
        f"tilted by {np.degrees(SPREADS[-1]):.0f}° and by {metres(found_error(narrow))} at "
        f"{np.degrees(SPREADS[0]):.1f}°: the error goes with the power {number(power, 2)} of the spread, while the "
        f"condition number stays at {number(narrow.summary('measures', 'condition_number')['median'], 2)}, as it sees "
        "the shape of the set and not its size. The smallest singular value is what falls. "
        f"{POSES[-1]} poses in place of 4 lower the predicted error from {metres(predicted_error(few))} to "
        f"{metres(predicted_error(many))} only: all are measured against pose 1, whose error stays.",
    )


def _shared_pose(many: Calibration) -> Notice:
    """Return what happens when pose 1 is taken as new in every row, and when no pose is singled out."""
    model, postures = flange_of(many), many.postures
    poses = np.array([model.tip_pose(q) for q in postures])
    covariances = pose_covariances(model, postures, _deviation(many))
    tips = tip_covariances(poses, covariances, np.array(many.config["robot"]["tool"]["tip"]))
    right = identify_tool_centre_point(poses, covariances).covariance
    wrong, together = independent_rows_covariance(poses, tips), common_point_covariance(poses, tips)
    errors, level = many.values("errors"), 0.99
    judged = consistency(errors, np.repeat(wrong[None], len(errors), axis=0), level)
    predicted = [metres(float(np.sqrt(np.trace(covariance)))) for covariance in (wrong, right, together)]
    return Notice(
        "finding",
        "Rows that share pose 1 are not independent",
        "Taken as new in every row, as least squares with $sigma^2 (A^T A)^(-1)$ does, pose 1 would be averaged away: "
        f"for {len(poses)} poses the predicted error would be {predicted[0]} in place of {predicted[1]}, and NEES of "
        f"the same {len(errors)} errors is {number(judged.mean)}, {'inside' if judged.holds else 'outside'} its band "
        f"of {number(judged.lower)} to {number(judged.upper)}. The equation itself can be mended: solved for the tip "
        f"and the point touched together, $R_k p - c = -P_k$, no pose is singled out, and {len(poses)} poses would "
        f"leave {predicted[2]}.",
    )


def tip_covariances(poses: FloatArray, covariances: FloatArray, tip: FloatArray) -> FloatArray:
    """Return the covariance of the tip's position in each pose, shape (N, 3, 3), in m^2.

    Args:
        poses: Flange in the base frame, shape (N, 4, 4).
        covariances: Of their errors, position in m and rotation vector in rad, shape (N, 6, 6).
        tip: The tool centre point in the flange's frame, shape (3,), in m.
    """
    levers = np.array([np.hstack([np.eye(3), -pin.skew(pose[:3, :3] @ tip)]) for pose in poses])
    at_tip: FloatArray = levers @ covariances @ levers.transpose(0, 2, 1)
    return at_tip


def independent_rows_covariance(poses: FloatArray, tips: FloatArray) -> FloatArray:
    """Return sigma^2 (A'A)^-1, shape (3, 3), in m^2, with sigma^2 twice the mean variance of a tip's coordinate.

    Args:
        poses: Flange in the base frame, shape (N, 4, 4).
        tips: Covariances of the tip's position in each, shape (N, 3, 3), in m^2.
    """
    A = (poses[0, :3, :3] - poses[1:, :3, :3]).reshape(-1, 3)
    covariance: FloatArray = 2.0 * np.einsum("kii->", tips) / (3.0 * len(tips)) * np.linalg.inv(A.T @ A)
    return covariance


def common_point_covariance(poses: FloatArray, tips: FloatArray) -> FloatArray:
    """Return the covariance of p where R_k p - c = -P_k is solved for p and c, shape (3, 3), in m^2.

    Args:
        poses: Flange in the base frame, shape (N, 4, 4).
        tips: Covariances of the tip's position in each, shape (N, 3, 3), in m^2.
    """
    A = np.vstack([np.hstack([pose[:3, :3], -np.eye(3)]) for pose in poses])
    blocks = np.linalg.pinv(A)[:3].reshape(3, len(poses), 3).transpose(1, 0, 2)
    covariance: FloatArray = np.sum(blocks @ tips @ blocks.transpose(0, 2, 1), axis=0)
    return covariance


def _refused(base: Calibration) -> Table:
    tip = np.array(base.config["robot"]["tool"]["tip"])
    axis = np.array([0.0, 0.6, 0.8])
    attempts = {
        "2 poses": [np.zeros(3), 0.5 * axis],
        "4 poses turned about one axis by 0, 20, 40 and 60 deg": [np.radians(20.0 * k) * axis for k in range(4)],
        "4 poses turned about one axis but for 0.2 deg": [
            np.radians(20.0 * k) * axis + np.radians(0.2) * np.eye(3)[k % 3] for k in range(4)
        ],
        "4 poses tilted by 0.1 deg": [np.radians(0.1) * v for v in (*np.eye(3), -np.ones(3) / np.sqrt(3.0))],
    }

    def attempt(turns: list[FloatArray]) -> str:
        poses = np.tile(np.eye(4), (len(turns), 1, 1))
        poses[:, :3, :3] = [pin.exp3(turn) for turn in turns]
        poses[:, :3, 3] = -poses[:, :3, :3] @ tip
        return refusal(lambda: identify_tool_centre_point(poses, np.zeros((len(turns), 6, 6))))

    return Table(
        "Sets of poses that are refused, and why.",
        ["set", "reason given"],
        [[name, attempt(turns)] for name, turns in attempts.items()],
    )
