"""What the sections on calibrations share: errors over the repetitions beside what the covariances predict."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from runner.errors import ConfigError
from runner.reporting.document import FloatArray, Panel, Series
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity, with_powers
from runner.robots import RobotModel
from runner.store import Calibration
from runner.works.meca500.calibration_plan import name_of

Calibrations = Mapping[str, Calibration]


def flange_of(calibration: Calibration) -> RobotModel:
    """Return the arm that was calibrated, with its flange as tip."""
    return RobotModel(calibration.urdf, calibration.provenance["flange"], calibration.config["gravity"])


def found_error(calibration: Calibration, *names: str) -> float:
    """Return the root mean square over the repetitions of the length of an error, of its named components or of all."""
    return float(np.sqrt(np.mean(np.sum(calibration.values("errors", *names) ** 2, axis=1))))


def predicted_error(calibration: Calibration, *names: str) -> float:
    """Return what the covariances say of `found_error`."""
    return float(np.sqrt(np.mean(np.sum(calibration.values("deviations", *names) ** 2, axis=1))))


def consistency_cells(calibration: Calibration) -> list[str]:
    """Return the mean normalised error squared, its band, and whether it lies there, for a table."""
    judged = calibration.consistency
    if judged is None:
        return ["–", "–", "–"]
    band = f"{number(judged['lower'])} to {number(judged['upper'])}"
    return [number(judged["mean"]), band, "yes" if judged["holds"] else "no"]


CONSISTENCY_HEADER = ("NEES", "99 % band", "inside")


def error_curves(
    calibrations: Calibrations,
    variations: Mapping[str, Sequence[float]],
    x_label: str,
    y_label: str,
    *names: str,
    log: bool = True,
    x_factor: float = 1.0,
    y_factor: float = 1.0,
) -> Panel:
    """Return errors over what was varied: found as points, predicted as lines.

    Args:
        calibrations: The calibrations by name.
        variations: Values of what was varied, by the first part of the calibrations' names; 0 is left out.
        x_label: Label of the values.
        y_label: Label of the errors.
        names: The components that make the error; none for all.
        log: Whether the axes are logarithmic.
        x_factor: From the values as they are to those shown.
        y_factor: From errors in m, rad, kg to those shown.
    """
    series = []
    for color, (variation, all_values) in enumerate(variations.items()):
        values = [value for value in all_values if value > 0.0]
        done = [calibrations[name_of(variation, value)] for value in values]
        label = f"{variation.rpartition('/')[2]}, " if len(variations) > 1 else ""
        x = x_factor * np.array(values, dtype=float)
        found, predicted = (
            y_factor * np.array([error(calibration, *names) for calibration in done])
            for error in (found_error, predicted_error)
        )
        series += [
            Series(f"{label}found", x, found, "points", color=color),
            Series(f"{label}predicted", x, predicted, "line", color=color),
        ]
    return Panel("", x_label, y_label, series, x_log=log, y_log=log)


def consistency_values(calibrations: Calibrations, kind: str) -> dict[str, Measured]:
    """Return in how many calibrations of a kind the errors are as large as predicted."""
    judged = [
        calibration.consistency
        for name, calibration in calibrations.items()
        if name.startswith(f"{kind}/") and calibration.consistency is not None
    ]
    inside = sum(bool(consistency["holds"]) for consistency in judged)
    level = 100.0 * min(consistency["level"] for consistency in judged)
    return {
        "inside": Measured("calibrations with NEES inside its band", inside),
        "count": Measured("calibrations", len(judged)),
        "outside": Measured("calibrations with NEES outside its band", len(judged) - inside),
        "level": Measured("band", level, "%"),
        "chance": Measured("what chance puts outside", 100.0 - level, "%"),
    }


def consistency_finding(
    inside: Measured, count: Measured, outside: Measured, level: Measured, chance: Measured
) -> Finding:
    """Return whether errors are as large as predicted; of so few calibrations chance puts one outside at most."""
    return finding(
        "Errors are as large as predicted",
        f"The mean normalised estimation error squared (NEES) $e^T P^(-1) e$ lies in its {level} chi-square band in "
        f"{inside} of {count} of these calibrations. Each draws from a seed of its own: they share no draws, and "
        f"chance alone puts {chance} of them outside.",
        outside < 2.0,
        inside >= 0.8 * count,
    )


def refusal(attempt: Callable[[], object]) -> str:
    """Return why something is refused, the config's key left out.

    Args:
        attempt: A function without arguments that raises a ConfigError.
    """
    try:
        attempt()
    except ConfigError as error:
        return with_powers(error.problems[0].partition(": ")[2])
    return "not refused"


def fit(values: FloatArray, errors: FloatArray) -> float:
    """Return the power of the values with which errors grow, by least squares of the logarithms."""
    return float(np.polyfit(np.log(values), np.log(errors), 1)[0])


def metres(value: float) -> str:
    """Return a short length in micrometres."""
    return quantity(1e6 * value, "µm")
