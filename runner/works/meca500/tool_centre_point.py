"""The tool centre point by touching one point (section 2 of the report), judged by the true one."""

import numpy as np
import pinocchio as pin

from runner.calibration import consistency, identify_tool_centre_point, joint_deviation, pose_covariances
from runner.reporting.document import Block, Curves, FloatArray, Formula, Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number
from runner.store import Calibration
from runner.works.meca500.calibration_plan import POSES, REPEATABILITIES, SPREADS, name_of
from runner.works.meca500.calibration_studies import (
    CONSISTENCY_HEADER,
    Calibrations,
    consistency_cells,
    consistency_finding,
    consistency_values,
    error_curves,
    fit,
    flange_of,
    found_error,
    metres,
    predicted_error,
    refusal,
)

_KIND = "tool_centre_point"
_DEGREES = float(np.degrees(1.0))
_FEW = 4  # poses, of the base case


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
        spread_finding(**spread_values(calibrations)),
        consistency_finding(**consistency_values(calibrations, _KIND)),
        shared_pose_finding(**shared_pose_values(calibrations[name_of(f"{_KIND}/poses", POSES[-1])])),
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
        ("spread", "spread (deg)", SPREADS, _DEGREES),
    )
    rows = []
    for key, title, values, factor in variations:
        for value in values:
            done = calibrations[name_of(f"{_KIND}/{key}", value)]
            rows.append(
                [
                    title,
                    number(float(factor * value)),
                    number(1e6 * found_error(done), rounding=1e6 * ROUNDING),
                    number(1e6 * predicted_error(done)),
                    number(done.summary("measures", "condition_number")["median"]),
                    number(done.summary("measures", "smallest_singular_value")["median"]),
                    *consistency_cells(done),
                ]
            )
    return rows


def _curves(calibrations: Calibrations) -> Curves:
    y_label = "error of the tip (µm)"
    panels = (
        error_curves(
            calibrations,
            {f"{_KIND}/repeatability": REPEATABILITIES},
            "repeatability (µm)",
            y_label,
            x_factor=1e6,
            y_factor=1e6,
        ),
        error_curves(calibrations, {f"{_KIND}/poses": POSES}, "number of poses", y_label, log=False, y_factor=1e6),
        error_curves(
            calibrations, {f"{_KIND}/spread": SPREADS}, "spread (deg)", y_label, x_factor=_DEGREES, y_factor=1e6
        ),
    )
    return Curves(
        "Error of the tool centre point over repeatability, number and spread of the poses.",
        panels,
        3,
        origin(calibrations[f"{_KIND}/base"]),
    )


def spread_values(calibrations: Calibrations) -> dict[str, Measured]:
    """Return what the finding on number and spread of the poses is about."""
    exact = calibrations[name_of(f"{_KIND}/repeatability", 0.0)]
    narrow, wide = (calibrations[name_of(f"{_KIND}/spread", value)] for value in (SPREADS[0], SPREADS[-1]))
    few, many = (calibrations[name_of(f"{_KIND}/poses", count)] for count in (_FEW, POSES[-1]))
    spread_errors = [predicted_error(calibrations[name_of(f"{_KIND}/spread", value)]) for value in SPREADS]
    measures = {
        (name, place): float(done.summary("measures", name)["median"])
        for name in ("condition_number", "smallest_singular_value")
        for place, done in (("narrow", narrow), ("wide", wide))
    }
    return {
        "exact": Measured("largest error without noise", float(np.abs(exact.values("errors")).max()), "m"),
        "wide_spread": Measured("widest spread", float(np.degrees(SPREADS[-1])), "°"),
        "wide": Measured("error of the widest spread", 1e6 * found_error(wide), "µm"),
        "narrow_spread": Measured("narrowest spread", float(np.degrees(SPREADS[0])), "°"),
        "narrow": Measured("error of the narrowest spread", 1e6 * found_error(narrow), "µm"),
        "power": Measured(
            "power of the spread in the predicted error", fit(np.array(SPREADS), np.array(spread_errors))
        ),
        "condition": Measured("condition number of the narrowest spread", measures["condition_number", "narrow"]),
        "wide_condition": Measured("condition number of the widest spread", measures["condition_number", "wide"]),
        "singular": Measured(
            "least singular value of the narrowest spread", measures["smallest_singular_value", "narrow"]
        ),
        "wide_singular": Measured(
            "least singular value of the widest spread", measures["smallest_singular_value", "wide"]
        ),
        "few_poses": Measured("poses of the base case", _FEW),
        "few": Measured("predicted error of the base case", 1e6 * predicted_error(few), "µm"),
        "many_poses": Measured("largest number of poses", POSES[-1]),
        "many": Measured("predicted error with the most poses", 1e6 * predicted_error(many), "µm"),
    }


def spread_finding(
    exact: Measured,
    wide_spread: Measured,
    wide: Measured,
    narrow_spread: Measured,
    narrow: Measured,
    power: Measured,
    condition: Measured,
    wide_condition: Measured,
    singular: Measured,
    wide_singular: Measured,
    few_poses: Measured,
    few: Measured,
    many_poses: Measured,
    many: Measured,
) -> Finding:
    """Return what the spread of the poses and their number do to the error of the tip."""
    return finding(
        "The spread of the poses counts, their number little",
        f"Without noise the tip is found to rounding: {exact.shown}. {few_poses} poses err by {wide} when tilted by "
        f"{wide_spread} and by {narrow} at {narrow_spread}: the error goes with the power {power} of the spread, while "
        f"the condition number, {condition} and {wide_condition}, sees the shape of the set and not its size. The "
        f"smallest singular value is what falls, from {wide_singular} to {singular}. {many_poses} poses in place of "
        f"{few_poses} lower the predicted error from {few} to {many}.",
        exact < ROUNDING,
        narrow > 5.0 * wide,
        power.near(-1.0, 0.1),
        condition.near(wide_condition, 0.1),
        wide_singular > 5.0 * singular,
        many < 0.9 * few,
        many > 0.6 * few,
    )


def shared_pose_values(many: Calibration) -> dict[str, Measured]:
    """Return what the finding on pose 1, which stands in every row, is about."""
    model, postures = flange_of(many), many.postures
    poses = np.array([model.tip_pose(q) for q in postures])
    covariances = pose_covariances(model, postures, _deviation(many))
    tips = tip_covariances(poses, covariances, np.array(many.config["robot"]["tool"]["tip"]))
    right = identify_tool_centre_point(poses, covariances).covariance
    wrong, together = independent_rows_covariance(poses, tips), common_point_covariance(poses, tips)
    errors, level = many.values("errors"), 0.99
    judged = consistency(errors, np.repeat(wrong[None], len(errors), axis=0), level)
    predicted = {"wrong": wrong, "right": right, "together": together}
    titles = {
        "wrong": "with rows taken as independent",
        "right": "with pose 1 shared",
        "together": "with no pose singled out",
    }
    return {
        key: Measured(f"predicted error {titles[key]}", 1e6 * float(np.sqrt(np.trace(covariance))), "µm")
        for key, covariance in predicted.items()
    } | {
        "poses": Measured("poses", len(poses)),
        "errors": Measured("errors", len(errors)),
        "nees": Measured("NEES with rows taken as independent", float(judged.mean)),
        "lower": Measured("lower end of its band", float(judged.lower)),
        "upper": Measured("upper end of its band", float(judged.upper)),
    }


def shared_pose_finding(
    wrong: Measured,
    right: Measured,
    together: Measured,
    poses: Measured,
    errors: Measured,
    nees: Measured,
    lower: Measured,
    upper: Measured,
) -> Finding:
    """Return what happens when pose 1 is taken as new in every row, and when no pose is singled out."""
    return finding(
        "Rows that share pose 1 are not independent",
        "Taken as new in every row, as least squares with $sigma^2 (A^T A)^(-1)$ does, pose 1 would be averaged away: "
        f"for {poses} poses the predicted error would be {wrong} in place of {right}, and NEES of the same {errors} "
        f"errors is {nees}, above its band of {lower} to {upper}. The equation itself can be mended: solved for the "
        f"tip and the point touched together, $R_k p - c = -P_k$, no pose is singled out, and {poses} poses would "
        f"leave {together}.",
        wrong < 0.8 * right,
        nees > 1.2 * upper,
        lower < upper,
        together < 0.7 * right,
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
