"""The misprinted equations of the gravity compensation beside the right ones, with what each gives."""

import numpy as np

from runner.reporting.document import FloatArray, Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.quantities import number, quantity
from runner.store import Calibration
from runner.works.meca500.calibration_studies import flange_of
from runner.works.meca500.gravity_printed import (
    force_step,
    swapped_moment_step,
    theta_by_arc_cosine,
    theta_by_arc_sine,
)
from runner.works.meca500.gravity_residual import exact_readings

_ANGLES = (0.3, -0.3, 2.0, -2.0)  # rad


def misprints_section(exact: Calibration) -> Section:
    """Return what printed and right equations give on readings without noise.

    Args:
        exact: A calibration of exact sensor and arm.
    """
    model = flange_of(exact)
    orientations = np.array([model.tip_pose(q)[:3, :3] for q in exact.postures])
    truth = np.array(list(exact.truth.values()))
    gravity = float(exact.config["gravity"])
    readings = exact_readings(truth, orientations, gravity)
    return Section(
        "Misprinted and right",
        (
            Text(
                f"Exact readings in the {len(orientations)} orientations, put through the equations as printed and as "
                "they must be; where a symbol is not defined, as it can be read. $rho$ is the third row of the "
                "rotation of frame 6 in frame 0, the vertical in the flange's frame."
            ),
            Table(
                "Section 4 as printed or read in one way, put right or read in another, and what each gives for the "
                f"tool of {quantity(truth[0], 'kg')} with $theta = {truth[1]:g}$ rad.",
                ["printed, or one reading", "right", "printed gives", "right gives"],
                [
                    _undefined_rotation(readings, orientations, gravity),
                    _swapped_axes(readings, truth),
                    _wrong_bias(truth),
                    _theta(truth),
                ],
                origin=origin(exact),
            ),
            _angles(exact, truth, orientations, gravity),
        ),
    )


def _undefined_rotation(readings: FloatArray, orientations: FloatArray, gravity: float) -> list[str]:
    cells = []
    for R in (orientations.transpose(0, 2, 1), orientations):
        step = force_step(readings[:, :3], R)
        theta = float(np.arctan2(step.G_s, step.G_c))
        cells.append(
            f"{quantity(step.G / gravity, 'kg')}, $theta = {theta:.3g}$ rad, {_near_zero(step.residual, 'N')} of the "
            "forces left over"
        )
    return [
        '$r_02, r_12, r_22$, where $r$ is not defined, read as elements of $""_6^0 R$: its third column',
        'read as elements of the inverse rotation $""_0^6 R$, whose third column is $rho$',
        *cells,
    ]


def _swapped_axes(readings: FloatArray, truth: FloatArray) -> list[str]:
    centre = swapped_moment_step(readings[:, :3], readings[:, 3:])
    wrong, right = (f"centre of mass ({', '.join(f'{1e3 * v:.1f}' for v in r)}) mm" for r in (centre, truth[2:5]))
    return ["$G_z = F_y - F_(y 0), G_y = F_z - F_(z 0)$", "$G_y = F_y - F_(y 0), G_z = F_z - F_(z 0)$", wrong, right]


def _wrong_bias(truth: FloatArray) -> list[str]:
    offset = truth[8:] - truth[5:8]
    worst = float(np.abs(offset).max())
    return [
        "$M_(g x) = M_x - F_(x 0)$, and so on",
        "$M_(g x) = M_x - M_(x 0)$, and so on",
        f"moments up to {quantity(worst, 'N m')} off, forces taken from moments",
        "moments without bias",
    ]


def _theta(truth: FloatArray) -> list[str]:
    return [
        '$theta = "acos"(G_c / G)$ or $"asin"(G_s / G)$',
        '$theta = "atan2"(G_s, G_c)$',
        f"sign or half turn lost; at $theta = {truth[1]:g}$ rad an error of $G_c$ counts "
        f"{number(1.0 / abs(np.sin(truth[1])), 2)} times, and errors of $G$ come in",
        "every angle, errors of $G$ without effect",
    ]


def _angles(exact: Calibration, truth: FloatArray, orientations: FloatArray, gravity: float) -> Table:
    rows = []
    for angle in _ANGLES:
        turned = truth.copy()
        turned[1] = angle
        step = force_step(exact_readings(turned, orientations, gravity)[:, :3], orientations)
        found = (
            theta_by_arc_cosine(step.G_c, step.G),
            theta_by_arc_sine(step.G_s, step.G),
            float(np.arctan2(step.G_s, step.G_c)),
        )
        rows.append([f"{angle:g}", *(f"{value:.3f}" for value in found)])
    return Table(
        "Mounting angle by the printed formulas and by the arc tangent of two arguments, in rad.",
        ["true $theta$", "arc cosine", "arc sine", "two arguments"],
        rows,
        (0, 1, 2, 3),
        origin(exact),
    )


def _near_zero(value: float, unit: str) -> str:
    return f"0 {unit}" if value < 1e-9 else quantity(value, unit)
