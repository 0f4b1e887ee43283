"""Tool direction and alignment (section 3 of the report), judged by the true direction."""

import numpy as np

from runner.calibration.tool_direction import alignment, alignment_angles
from runner.reporting.document import Block, Curves, FloatArray, Formula, Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number
from runner.works.meca500.calibration_plan import DIRECTION_POSES, DIRECTION_REPEATABILITIES, SHORTER, name_of
from runner.works.meca500.calibration_studies import (
    CONSISTENCY_HEADER,
    Calibrations,
    consistency_cells,
    consistency_finding,
    consistency_values,
    error_curves,
    found_error,
    predicted_error,
)

_KIND = "tool_direction"
_INSERTED = 0.02  # m, about the length of a root canal file


def tool_direction_section(calibrations: Calibrations) -> Section:
    """Return the alignment, errors over the tools' difference, repeatability and number of poses, and the misprint."""
    base = calibrations[f"{_KIND}/base"]
    config = base.config["calibration"]
    along = ", ".join(f"{value:g}" for value in config["direction"])
    alpha, beta = (float(np.degrees(base.truth[name])) for name in ("alpha", "beta"))
    blocks: list[Block] = [
        Text(
            "Two tools of different length, calibrated apart, give the direction in which the tool is inserted. The "
            f"report's example is taken as the truth, $t$ along ({along}) of the flange's frame, with a short tool "
            f"whose tip stands back by {1e3 * config['shorter']:g} mm. The flange's z axis is brought onto $t$ by a "
            "turn about x and one about the new y:"
        ),
        Formula(
            'R_x (alpha) R_y (beta) e_z = t, quad alpha = "atan2"(-t_y, t_z), '
            'quad beta = "atan2"(t_x, sqrt(t_y^2 + t_z^2))',
            "R x of alpha R y of beta times e z equals t, alpha is the arc tangent of minus t y and t z, beta that of "
            "t x and the root of t y squared plus t z squared",
            "6, 7",
        ),
        Text(
            f"For the example $alpha = {alpha:.2f}°$ and $beta = {beta:.2f}°$. Along x, where any $alpha$ does, it is "
            "taken as zero. As the angles then say little, the direction is judged by its tilt about the aligned "
            "frame's axes."
        ),
        Table(
            "Found and predicted angle between the found and the true direction (root mean square over "
            f"{base.record['repetitions']} repetitions). The expectation of NEES is 2.",
            ["varied", "value", "error (mrad)", "predicted (mrad)", *CONSISTENCY_HEADER],
            _rows(calibrations),
            (1, 2, 3, 4, 5),
            origin(base),
        ),
        Curves(
            "Error of the tool's direction over what the tools differ by, and over the arm's repeatability.",
            (
                error_curves(
                    calibrations,
                    {f"{_KIND}/shorter": SHORTER},
                    "difference of the tools (mm)",
                    "error (mrad)",
                    x_factor=1e3,
                    y_factor=1e3,
                ),
                error_curves(
                    calibrations,
                    {f"{_KIND}/repeatability": DIRECTION_REPEATABILITIES},
                    "repeatability (µm)",
                    "error (mrad)",
                    x_factor=1e6,
                    y_factor=1e3,
                ),
            ),
            2,
            origin(base),
        ),
        direction_finding(**direction_values(calibrations)),
        consistency_finding(**consistency_values(calibrations, _KIND)),
        alignment_finding(**alignment_values(np.array(config["direction"]))),
    ]
    return Section("Tool direction and alignment", blocks)


def _rows(calibrations: Calibrations) -> list[list[str]]:
    variations = (
        ("shorter", "difference of the tools (mm)", SHORTER, 1e3),
        ("repeatability", "repeatability (µm)", DIRECTION_REPEATABILITIES, 1e6),
        ("poses", "number of poses with each", DIRECTION_POSES, 1.0),
    )
    rows = []
    for key, title, values, factor in variations:
        for value in values:
            done = calibrations[name_of(f"{_KIND}/{key}", value)]
            errors = (number(1e3 * error(done), rounding=1e3 * ROUNDING) for error in (found_error, predicted_error))
            rows.append([title, number(factor * value), *errors, *consistency_cells(done)])
    return rows


def direction_values(calibrations: Calibrations) -> dict[str, Measured]:
    """Return what the finding on the tool's direction is about."""
    exact = calibrations[name_of(f"{_KIND}/repeatability", 0.0)]
    short, long = (calibrations[name_of(f"{_KIND}/shorter", value)] for value in (SHORTER[0], SHORTER[-1]))
    return {
        "exact": Measured("largest error without noise", float(np.abs(exact.values("errors")).max()), "rad"),
        "short_by": Measured("least difference of the tools", 1e3 * SHORTER[0], "mm"),
        "long_by": Measured("largest difference of the tools", 1e3 * SHORTER[-1], "mm"),
        "short": Measured("error with the least difference", 1e3 * found_error(short), "mrad"),
        "short_predicted": Measured("predicted error with the least difference", 1e3 * predicted_error(short), "mrad"),
        "long": Measured("error with the largest difference", 1e3 * found_error(long), "mrad"),
        "long_predicted": Measured("predicted error with the largest difference", 1e3 * predicted_error(long), "mrad"),
        "over": Measured("way of insertion", 1e3 * _INSERTED, "mm"),
        "aside": Measured("how far the insertion ends aside", 1e6 * _INSERTED * found_error(short), "µm"),
    }


def direction_finding(
    exact: Measured,
    short_by: Measured,
    long_by: Measured,
    short: Measured,
    short_predicted: Measured,
    long: Measured,
    long_predicted: Measured,
    over: Measured,
    aside: Measured,
) -> Finding:
    """Return what the difference of the tools in length does to the error of the direction."""
    return finding(
        "The error of the direction falls as the tools differ more in length",
        f"Without noise the direction is found to rounding: {exact.shown}. Tools that differ by {short_by} leave "
        f"{short} (predicted: {short_predicted}), by {long_by} {long} (predicted: {long_predicted}): the tips' error "
        f"over their distance. Over {over} of insertion the first is {aside} aside.",
        exact < ROUNDING,
        (short_predicted / long_predicted).near(long_by / short_by, 0.15),
        short.near(short_predicted, 0.35),
        long.near(long_predicted, 0.35),
        aside < 100.0,
    )


def alignment_values(direction: FloatArray) -> dict[str, Measured]:
    """Return what the finding on equation 7 is about."""
    t = direction / np.linalg.norm(direction)
    R = alignment(*alignment_angles(t))
    printed, described = (float(np.degrees(np.arccos(np.clip(turned[:, 2] @ t, -1.0, 1.0)))) for turned in (R.T, R))
    return {
        "printed": Measured("angle to the tool, read as printed", printed, "°"),
        "described": Measured("angle to the tool, read as described", described, "°"),
    }


def alignment_finding(printed: Measured, described: Measured) -> Finding:
    """Return which frame stands in which in equation 7."""
    return finding(
        "The alignment is the tool's frame in frame 6",
        'Equation 7 calls the product the rotation of frame 6 in the tool\'s, $""_6^T R$. The turns that the text '
        'describes, z onto the projection and then onto $t$, make it the tool\'s frame in frame 6, $""_T^6 R$. Read as '
        f"printed, the tool of the example would be sent {printed} away from $t$.",
        printed > 10.0,
        described < 1e-3,
    )
