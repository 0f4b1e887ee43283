"""Gravity compensation (section 4 of the report), judged by the true tool and sensor."""

from collections.abc import Mapping

import numpy as np

from runner.calibration import identify_gravity
from runner.reporting.document import Curves, Formula, Section, Table, Text
from runner.reporting.figures import columns, joint_columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number, with_interval
from runner.store import Calibration, Run
from runner.works.meca500.calibration_plan import NOISES, SAMPLES, name_of
from runner.works.meca500.calibration_studies import (
    Calibrations,
    consistency_finding,
    consistency_values,
    error_curves,
    flange_of,
    found_error,
    predicted_error,
)
from runner.works.meca500.gravity_misprints import misprints_section
from runner.works.meca500.gravity_orientations import orientations_section
from runner.works.meca500.gravity_residual import residual_section

_INTERVAL = 0.95
_HALF = 1.959964  # standard deviations, of that interval
_SCALED = {"kg": ("g", 1e3), "rad": ("mrad", 1e3), "m": ("mm", 1e3), "N": ("mN", 1e3), "N m": ("mN m", 1e3)}


def gravity_section(calibrations: Calibrations, runs: Mapping[str, Run]) -> Section:
    """Return the identification, its orientations, what the compensation leaves, the misprints, and PyBullet's check.

    Args:
        calibrations: The calibrations by name.
        runs: The report's runs by name, of which "rest/..." weigh the tool in PyBullet.
    """
    base, exact = calibrations["gravity/base"], calibrations[name_of("gravity/noise", 0.0)]
    return Section(
        "Gravity compensation",
        sections=(
            _identification(calibrations, base, exact),
            orientations_section(calibrations),
            residual_section(base),
            misprints_section(exact),
            _weighed_in_bullet([run for name, run in runs.items() if name.startswith("rest/")], base),
        ),
    )


def _identification(calibrations: Calibrations, base: Calibration, exact: Calibration) -> Section:
    config = base.config["calibration"]
    return Section(
        "Tool and sensor identified",
        (
            Text(
                "At rest the sensor reads its biases and the tool's weight. The moment step gives the centre of mass "
                "$r$ and $k$, the force step the weight $G$, the mounting angle $theta$ and the force biases, and the "
                "moment biases follow:"
            ),
            Formula(
                "M = -[F]_times r + k, quad F = F_0 - vec(rho_x G_c + rho_y G_s, rho_y G_c - rho_x G_s, rho_z G), "
                'quad theta = "atan2"(G_s, G_c), quad M_0 = k + r times F_0',
                "M equals minus F cross r plus k; F equals F 0 minus the weight along the sensor's axes; theta is the "
                "arc tangent of G s and G c; M 0 equals k plus r cross F 0",
            ),
            Text(
                f"A Mini40 reads the tool in {config['orientations']} orientations, {config['samples']} readings "
                "averaged in each; the joint positions err by the arm's repeatability. The covariance carries noise, "
                "quantisation $q^2 slash 12$ and the orientations' errors through both steps; the noise of the forces "
                "enters the moment step twice, in its matrix and its right side."
            ),
            _parameters(base, exact),
            identification_finding(**identification_values(calibrations)),
            _noise_curves(calibrations),
            consistency_finding(**consistency_values(calibrations, "gravity")),
        ),
    )


def identification_values(calibrations: Calibrations) -> dict[str, Measured]:
    """Return what the finding on the identified tool and sensor is about."""
    base, exact = calibrations["gravity/base"], calibrations[name_of("gravity/noise", 0.0)]
    relative = np.abs(exact.values("errors")[0]) / np.abs(np.array(list(exact.truth.values())))
    found = {"mass": ("mass", "g", 1e3), "theta": ("mounting angle", "mrad", 1e3), "r": ("centre of mass", "µm", 1e6)}
    values = {"exact": Measured("largest relative error without noise", float(relative.max()))}
    for key, (title, unit, factor) in found.items():
        names = ("r_x", "r_y", "r_z") if key == "r" else (key,)
        values[key] = Measured(f"error of the {title}", factor * found_error(base, *names), unit)
        values[f"{key}_predicted"] = Measured(
            f"predicted error of the {title}", factor * predicted_error(base, *names), unit
        )
    return values | {
        "interval": Measured("interval", 100.0 * _INTERVAL, "%"),
        "held": Measured("intervals that hold the truth", 100.0 * float(np.mean(_held(base))), "%"),
    }


def identification_finding(
    exact: Measured,
    mass: Measured,
    mass_predicted: Measured,
    theta: Measured,
    theta_predicted: Measured,
    r: Measured,
    r_predicted: Measured,
    interval: Measured,
    held: Measured,
) -> Finding:
    """Return how well tool and sensor are found, and whether the covariance tells it."""
    return finding(
        "The covariance tells how far the estimates are off",
        f"Without noise and quantisation every value is found to rounding: {exact.shown}, relative. With the Mini40's, "
        f"the mass is found to {mass} (predicted: {mass_predicted}), the mounting angle to {theta} (predicted: "
        f"{theta_predicted}) and the centre of mass to {r} (predicted: {r_predicted}). The {interval} intervals hold "
        f"the truth in {held} of all cases.",
        exact < ROUNDING,
        mass.near(mass_predicted, 0.35),
        theta.near(theta_predicted, 0.35),
        r.near(r_predicted, 0.35),
        held.near(interval, 0.04),
    )


def _held(done: Calibration) -> np.ndarray:
    """Return whether each interval of each repetition holds the truth, shape (repetitions, 11)."""
    held: np.ndarray = np.abs(done.values("errors")) < _HALF * done.values("deviations")
    return held


def _parameters(base: Calibration, exact: Calibration) -> Table:
    rows = []
    for column, name in enumerate(base.truth):
        unit, factor = _SCALED[base.summary("errors", name)["unit"]]
        deviation = base.summary("deviations", name)["median"]
        rows.append(
            [
                name.replace("_", " "),
                unit,
                number(factor * base.truth[name], 4),
                *with_interval(factor * base.values("estimates", name)[0, 0], _HALF * factor * deviation),
                number(factor * found_error(base, name)),
                number(factor * predicted_error(base, name)),
                f"{100 * float(np.mean(_held(base)[:, column])):.0f} %",
                number(abs(factor * exact.values("errors", name)[0, 0]), 2, rounding=ROUNDING),
            ]
        )
    return Table(
        f"Identified tool and sensor: the first repetition with its {100 * _INTERVAL:g} % interval, the root mean "
        f"square of all {base.record['repetitions']} errors beside the predicted one, how many intervals hold the "
        "truth, and the error without noise.",
        ["value", "unit", "true", "found", "interval", "error", "predicted", "held", "without noise"],
        rows,
        (2, 3, 4, 5, 6, 7, 8),
        origin(base),
    )


def _noise_curves(calibrations: Calibrations) -> Curves:
    return Curves(
        "Errors over the sensor's noise (times the Mini40's) and over the number of readings averaged.",
        (
            error_curves(
                calibrations, {"gravity/noise": NOISES}, "noise, times the Mini40's", "mass (g)", "mass", y_factor=1e3
            ),
            error_curves(
                calibrations, {"gravity/samples": SAMPLES}, "readings averaged", "mass (g)", "mass", y_factor=1e3
            ),
            error_curves(
                calibrations, {"gravity/samples": SAMPLES}, "readings averaged", "angle (mrad)", "theta", y_factor=1e3
            ),
        ),
        3,
        origin(calibrations["gravity/base"]),
    )


def _weighed_in_bullet(runs: list[Run], base: Calibration) -> Section:
    """Return the identification from PyBullet's own reaction at the tool's joint, in place of the sensor's model."""
    model, gravity = flange_of(base), float(base.config["gravity"])
    orientations = np.array([model.tip_pose(joint_columns(run.trace, "q")[-1])[:3, :3] for run in runs])
    reactions = np.array(
        [np.concatenate([columns(run.trace, f"reaction_{part}")[-1] for part in ("force", "moment")]) for run in runs]
    )
    found = identify_gravity(reactions, orientations, gravity, np.zeros(6), np.zeros((len(runs), 3, 3)))
    tool = base.config["robot"]["tool"]
    truth = np.array([tool["mass"], 0.0, *tool["centre_of_mass"], *np.zeros(6)])
    off = np.abs(found.values - truth)
    return Section(
        "Weighed in the simulated arm",
        (
            Text(
                "The readings above are the tool's weight in the sensor's frame, exactly. As a check, the same "
                f"identification from PyBullet's reaction at the tool's joint, the arm held at rest in {len(runs)} "
                "random orientations:"
            ),
            Table(
                "Identified from PyBullet's joint reaction, in the flange's frame, less the truth.",
                ["mass (kg)", "$theta$ (rad)", "centre of mass (m)", "force biases (N)", "moment biases (N m)"],
                [[number(float(part.max()), 2, rounding=ROUNDING) for part in np.split(off, [1, 2, 5, 8])]],
                tuple(range(5)),
                origin(runs[0]),
            ),
        ),
    )
