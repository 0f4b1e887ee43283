"""Gravity compensation (section 4 of the report), corrected and as printed, compared with true tool and sensor."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number, quantity, with_interval
from runner.calibration.orientations import force_matrix, moment_matrix
from runner.calibration.weighing import even_postures
from runner.papers.studies.meca500.figures import Calibrations, error, flange_of, predicted
from runner.papers.study.measured import ROUNDING
from runner.store import Calibration

_EXACT = "gravity/noise/0"
_ORIENTATIONS = 300
_INTERVAL, _HALF = 95.0, 1.959964  # per cent that an interval holds, and its half width in standard deviations
_SCALED = {"kg": ("g", 1e3), "rad": ("mrad", 1e3), "m": ("mm", 1e3), "N": ("mN", 1e3), "N m": ("mN m", 1e3)}
_CASES = ("nothing taken off", "only biases", "identified tool and biases")


def identified(done: Calibration) -> dict[str, float]:
    """Return the largest relative error in the first repetition, and the intervals that hold the truth, in per cent.

    `interval` is the nominal value of the latter.
    """
    relative = np.abs(done.values("errors")[0]) / np.abs(_truth(done))
    return {"relative": float(relative.max()), "held": 100.0 * float(np.mean(_held(done))), "interval": _INTERVAL}


def parameters(calibrations: Calibrations, name: str) -> list[list[str]]:
    """Return a row for each value: name, unit, truth, first estimate with its interval, errors, share held, exact."""
    done, exact = calibrations[name], calibrations[_EXACT]
    rows = []
    for column, value in enumerate(done.truth):
        unit, factor = _SCALED[done.summary("errors", value)["unit"]]
        deviation = done.summary("deviations", value)["median"]
        rows.append(
            [
                value.replace("_", " "),
                unit,
                number(factor * done.truth[value], 4),
                *with_interval(factor * done.values("estimates", value)[0, 0], _HALF * factor * deviation),
                *(number(factor * what(value)(done)) for what in (error, predicted)),
                f"{100 * float(np.mean(_held(done)[:, column])):.0f} %",
                number(abs(factor * exact.values("errors", value)[0, 0]), 2, rounding=ROUNDING),
            ]
        )
    return rows


def residual(done: Calibration) -> dict[str, float]:
    """Return the root mean square of what compensation leaves, and the noise of a reading, in mN and mN m."""
    left = _left_over(done)[_CASES[2]]
    noise = np.array(done.config["wrist_sensor"]["noise"])
    return {
        "orientations": _ORIENTATIONS,
        "force": 1e3 * _rms(left[..., 0]),
        "moment": 1e3 * _rms(left[..., 1]),
        "force_noise": 1e3 * float(np.linalg.norm(noise[:3])),
        "moment_noise": 1e3 * float(np.linalg.norm(noise[3:])),
    }


def left_over(calibrations: Calibrations, name: str) -> list[list[str | float]]:
    """Return force in N and moment in N m felt though nothing touches the tool, rms and largest, for each case."""
    return [
        [case, *(value for part in (left[..., 0], left[..., 1]) for value in (_rms(part), float(part.max())))]
        for case, left in _left_over(calibrations[name]).items()
    ]


def misprints(calibrations: Calibrations) -> dict[str, str]:
    """Return the results of the printed and the right equations from exact readings, as strings."""
    exact = calibrations[_EXACT]
    truth, R, gravity = _truth(exact), _orientations(exact), float(exact.config["gravity"])
    readings = exact_readings(truth, R, gravity)
    given = {
        "mass": quantity(float(truth[0]), "kg"),
        "theta": f"{truth[1]:g}",
        "swapped": _in_mm(swapped_moment_step(readings[:, :3], readings[:, 3:])),
        "centre": _in_mm(truth[2:5]),
        "moment": quantity(float(np.abs(truth[8:] - truth[5:8]).max()), "N m"),
        "counted": number(1.0 / abs(float(np.sin(truth[1]))), 2),
    }
    for key, orientations in (("columns", R.transpose(0, 2, 1)), ("rows", R)):
        G_c, G_s, G, left = force_step(readings[:, :3], orientations)
        of_forces = "0 N" if left < 1e-9 else quantity(left, "N")
        theta = float(np.arctan2(G_s, G_c))
        given[key] = f"{quantity(G / gravity, 'kg')}, $theta = {theta:.3g}$ rad, {of_forces} of the forces left over"
    return given


def exact_readings(parameters: FloatArray, orientations: FloatArray, gravity: float) -> FloatArray:
    """Return noiseless readings of a tool at rest, by the parameters that a calibration estimates, shape (N, 6)."""
    mass, theta, (r, F_0, M_0) = parameters[0], parameters[1], np.split(parameters[2:], 3)
    weight = mass * gravity * np.array([np.cos(theta), np.sin(theta), 1.0])
    forces = (force_matrix(orientations) @ np.concatenate([weight, F_0])).reshape(-1, 3)
    moments = moment_matrix(forces) @ np.concatenate([r, M_0 - np.cross(r, F_0)])
    return np.hstack([forces, moments.reshape(-1, 3)])


def force_step(forces: FloatArray, orientations: FloatArray) -> tuple[float, float, float, float]:
    """Solve the force step with the third rows of the orientations; return G_c, G_s, G and the rms of what is left.

    All in N. The report does not define r. With r the inverse rotation its r_02, r_12, r_22 are these rows; with
    r = 0R6 they are the third columns: that is this function with each orientation, 0R6, transposed.
    """
    B = force_matrix(orientations)
    solution = np.linalg.lstsq(B, forces.reshape(-1), rcond=None)[0]
    G_c, G_s, G = solution[:3].tolist()
    return G_c, G_s, G, _rms(forces.reshape(-1) - B @ solution)


def swapped_moment_step(forces: FloatArray, moments: FloatArray) -> FloatArray:
    """Return the centre of mass with G_y and G_z swapped, as in the section's first equations, shape (3,), in m."""
    A = moment_matrix(forces[:, [0, 2, 1]])
    return np.array(np.linalg.lstsq(A, moments.reshape(-1), rcond=None)[0][:3], dtype=float)


def _truth(done: Calibration) -> FloatArray:
    return np.array(list(done.truth.values()))


def _orientations(done: Calibration) -> FloatArray:
    """Return 0R6 of each posture, shape (N, 3, 3)."""
    model = flange_of(done)
    return np.array([model.tip_pose(q)[:3, :3] for q in done.postures])


def _held(done: Calibration) -> np.ndarray:
    """Return True for each interval of each repetition that holds the truth, shape (repetitions, 11)."""
    return np.abs(done.values("errors")) < _HALF * done.values("deviations")


def _left_over(done: Calibration) -> dict[str, FloatArray]:
    """Return by what is taken off the force and moment left in some orientations, shape (..., N, 2)."""
    model = flange_of(done)
    orientations = np.array([model.tip_pose(q)[:3, :3] for q in even_postures(model, _ORIENTATIONS)])
    truth, gravity = _truth(done), float(done.config["gravity"])
    true = exact_readings(truth, orientations, gravity)
    estimated = [exact_readings(own, orientations, gravity) for own in done.values("estimates")]
    left: list[FloatArray] = [true[None], (true - truth[5:])[None], true - np.array(estimated)]
    parts = (np.linalg.norm(values.reshape(*values.shape[:-1], 2, 3), axis=-1) for values in left)
    return dict(zip(_CASES, parts, strict=True))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _in_mm(centre: FloatArray) -> str:
    return f"centre of mass ({', '.join(f'{1e3 * value:.1f}' for value in centre)}) mm"
