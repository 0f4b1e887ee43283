"""What compensation by an identified tool and sensor leaves of readings at rest, over orientations."""

import numpy as np

from runner.calibration.procedures.gravity import even_postures
from runner.reporting.document import Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.store import Calibration
from runner.works.meca500.calibration_studies import flange_of

_ORIENTATIONS = 300


def exact_readings(parameters: FloatArray, orientations: FloatArray, gravity: float) -> FloatArray:
    """Return what a sensor without noise reads of a tool at rest, shape (..., N, 6).

    Args:
        parameters: Mass, theta, centre of mass, force and moment biases in the order of the calibration's estimates,
            shape (..., 11).
        orientations: 0R6, shape (N, 3, 3).
        gravity: In m/s^2.
    """
    mass, theta, centre, bias = np.split(parameters[..., None, :], [1, 2, 5], axis=-1)
    x, y, z = orientations[:, 2].T
    c, s = np.cos(theta[..., 0]), np.sin(theta[..., 0])
    vertical = np.stack(np.broadcast_arrays(c * x + s * y, c * y - s * x, z + 0.0 * c), axis=-1)
    weight = -mass * gravity * vertical
    readings: FloatArray = np.concatenate([weight, np.cross(centre, weight)], axis=-1) + bias
    return readings


def residual_section(base: Calibration) -> Section:
    """Return what is left over orientations all over the joint limits, in every repetition of a calibration."""
    orientations, norms = _left_over(base)
    rows = [
        [case, *(number(value) for part in (0, 1) for value in (_rms(norm[..., part]), float(norm[..., part].max())))]
        for case, norm in norms.items()
    ]
    return Section(
        "What compensation leaves",
        (
            Text(
                f"Exact readings of the tool at rest in {_ORIENTATIONS} orientations spread evenly over the joint "
                f"limits, less what each of the {base.record['repetitions']} calibrations takes to be weight and bias. "
                "Nothing touches the tool, so that what is left would be felt as a push."
            ),
            Table(
                "Force and moment felt though nothing touches the tool, over all orientations and repetitions.",
                ["taken off", "force, rms (N)", "force, largest (N)", "moment, rms (N m)", "moment, largest (N m)"],
                rows,
                (1, 2, 3, 4),
                origin(base),
            ),
            _curves(base, orientations, norms["identified tool and biases"]),
            residual_finding(**residual_values(base)),
        ),
    )


def residual_values(base: Calibration) -> dict[str, Measured]:
    """Return what the finding on the compensation is about."""
    left = _left_over(base)[1]["identified tool and biases"]
    single = [float(np.linalg.norm(part)) for part in np.split(np.array(base.config["wrist_sensor"]["noise"]), 2)]
    return {
        "force": Measured("force left over", 1e3 * _rms(left[..., 0]), "mN"),
        "moment": Measured("moment left over", 1e3 * _rms(left[..., 1]), "mN m"),
        "force_noise": Measured("noise of a single reading's force", 1e3 * single[0], "mN"),
        "moment_noise": Measured("noise of a single reading's moment", 1e3 * single[1], "mN m"),
    }


def residual_finding(force: Measured, moment: Measured, force_noise: Measured, moment_noise: Measured) -> Finding:
    """Return what compensation leaves beside the noise of a reading."""
    return finding(
        "Less than the noise of a single reading",
        f"The compensation leaves {force} and {moment} (root mean square); a single reading's noise is {force_noise} "
        f"and {moment_noise}.",
        force < 0.5 * force_noise,
        moment < 0.5 * moment_noise,
    )


def _left_over(base: Calibration) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Return orientations, shape (N, 3, 3), and by what is taken off the force and moment left, shape (..., N, 2)."""
    model = flange_of(base)
    orientations = np.array([model.tip_pose(q)[:3, :3] for q in even_postures(model, _ORIENTATIONS)])
    truth, gravity = np.array(list(base.truth.values())), float(base.config["gravity"])
    true = exact_readings(truth, orientations, gravity)
    left = true - exact_readings(base.values("estimates"), orientations, gravity)
    cases = {
        "nothing taken off": true[None],
        "biases alone": (true - truth[5:])[None],
        "identified tool and biases": left,
    }
    return orientations, {
        case: np.linalg.norm(values.reshape(*values.shape[:-1], 2, 3), axis=-1) for case, values in cases.items()
    }


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _curves(base: Calibration, orientations: FloatArray, norms: FloatArray) -> Curves:
    tilt = np.degrees(np.arccos(np.clip(-orientations[:, 2, 2], -1.0, 1.0)))
    order = np.argsort(tilt)
    panels = []
    for part, (title, unit) in enumerate((("Force", "N"), ("Moment", "N m"))):
        middle, high = np.percentile(norms[:, order, part], [50, 95], axis=0)
        series = [
            Series("median of the repetitions", tilt[order], middle, "points"),
            Series("95th percentile", tilt[order], high, "points"),
        ]
        panels.append(Panel(title, "flange's z axis from straight down (deg)", f"left over ({unit})", series))
    return Curves("What compensation leaves in each orientation.", panels, 2, origin(base))
