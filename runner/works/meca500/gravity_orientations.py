"""Which orientations weigh a tool well: number, choice by conditioning, and spread."""

import numpy as np
import pinocchio as pin

from runner.calibration.orientations import check_orientations
from runner.reporting.document import Curves, FloatArray, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.store import Calibration
from runner.works.meca500.calibration_plan import CHOICES, ORIENTATIONS, WEIGHING_SPREADS, name_of
from runner.works.meca500.calibration_studies import (
    CONSISTENCY_HEADER,
    Calibrations,
    consistency_cells,
    found_error,
    predicted_error,
    refusal,
)

_TITLES = {"best": "by conditioning", "first": "evenly over the joints"}


def orientations_section(calibrations: Calibrations) -> Section:
    """Return conditioning and errors over number, choice and spread of the orientations, and what is refused."""
    base = calibrations["gravity/base"]
    return Section(
        "Choice of orientations",
        (
            Text(
                "Both steps see of an orientation nothing but $rho$. The choice by conditioning takes, of "
                f"{base.config['calibration']['candidates']} postures spread evenly over the joint limits, one after "
                "the other the one that adds most to the determinant of"
            ),
            Formula(
                "sum_i vec(1, rho_i) vec(1, rho_i)^T",
                "the sum over the orientations of the vector 1, rho times its transpose",
            ),
            Table(
                "Condition numbers of the two steps, errors of mass and mounting angle (root mean square), and NEES, "
                "whose expectation is 11.",
                [
                    "orientations",
                    "number",
                    "force step",
                    "moment step",
                    "mass (g)",
                    "predicted (g)",
                    "$theta$ (mrad)",
                    "predicted (mrad)",
                    *CONSISTENCY_HEADER,
                ],
                _rows(calibrations),
                (1, 2, 3, 4, 5, 6, 7, 8, 9),
                origin(base),
            ),
            _curves(calibrations),
            orientations_finding(**orientations_values(calibrations)),
            _refused(),
        ),
    )


def _row(title: str, done: Calibration) -> list[str]:
    conditions = (done.summary("measures", f"condition_{step}")["median"] for step in ("force", "moment"))
    errors = (1e3 * error(done, name) for name in ("mass", "theta") for error in (found_error, predicted_error))
    count = str(done.config["calibration"]["orientations"])
    return [title, count, *map(number, conditions), *map(number, errors), *consistency_cells(done)]


def _rows(calibrations: Calibrations) -> list[list[str]]:
    chosen = [
        _row(_TITLES[choice], calibrations[name_of(f"gravity/{choice}", count)])
        for choice in CHOICES
        for count in ORIENTATIONS
    ]
    spread = [
        _row(f"within {np.degrees(value):.0f}° of home", calibrations[name_of("gravity/spread", value)])
        for value in WEIGHING_SPREADS
    ]
    return chosen + spread


def _curves(calibrations: Calibrations) -> Curves:
    counts = np.array(ORIENTATIONS, dtype=float)
    conditions, errors = [], []
    for color, choice in enumerate(CHOICES):
        done = [calibrations[name_of(f"gravity/{choice}", count)] for count in ORIENTATIONS]
        condition = np.array([c.summary("measures", "condition_force")["median"] for c in done])
        conditions.append(Series(_TITLES[choice], counts, condition, "points_line", color=color))
        found, predicted = (
            1e3 * np.array([error(c, "mass") for c in done]) for error in (found_error, predicted_error)
        )
        errors.append(Series(f"{_TITLES[choice]}, found", counts, found, "points", color=color))
        errors.append(Series(f"{_TITLES[choice]}, predicted", counts, predicted, "line", color=color))
    return Curves(
        "Conditioning and the mass's error over the number of orientations.",
        (
            Panel("Force step", "orientations", "condition number", conditions),
            Panel("Mass", "orientations", "error (g)", errors, x_log=True, y_log=True),
        ),
        2,
        origin(calibrations["gravity/base"]),
    )


def orientations_values(calibrations: Calibrations) -> dict[str, Measured]:
    """Return what the finding on the choice of orientations is about."""
    few, many = ORIENTATIONS[0], ORIENTATIONS[-1]
    best, first = (calibrations[name_of(f"gravity/{choice}", few)] for choice in CHOICES)
    best_many, first_many = (calibrations[name_of(f"gravity/{choice}", many)] for choice in CHOICES)
    narrow, base = calibrations[name_of("gravity/spread", WEIGHING_SPREADS[0])], calibrations["gravity/base"]
    return {
        "few": Measured("smallest number of orientations", few),
        "best": _mass("those chosen by conditioning", best),
        "first": _mass("the first of an even spread", first),
        "many": Measured("largest number of orientations", many),
        "best_many": _mass("many chosen by conditioning", best_many),
        "first_many": _mass("many of an even spread", first_many),
        "spread": Measured("narrowest spread of gravity", float(np.degrees(WEIGHING_SPREADS[0])), "°"),
        "count": Measured("orientations of the base case", base.config["calibration"]["orientations"]),
        "narrow": _mass("the narrowest spread", narrow),
        "wide": _mass("the base case", base),
        "narrow_condition": Measured("condition number of the narrowest spread", _condition(narrow)),
        "wide_condition": Measured("condition number of the base case", _condition(base)),
    }


def orientations_finding(
    few: Measured,
    best: Measured,
    first: Measured,
    many: Measured,
    best_many: Measured,
    first_many: Measured,
    spread: Measured,
    count: Measured,
    narrow: Measured,
    wide: Measured,
    narrow_condition: Measured,
    wide_condition: Measured,
) -> Finding:
    """Return which orientations weigh a tool well."""
    return finding(
        "Few orientations must be chosen, many need not; but they must be spread",
        f"Of {few} orientations those chosen by conditioning know the mass to {best}, the first ones of an even spread "
        f"to {first}; with {many} it is {best_many} and {first_many}. With gravity within {spread} of where it is at "
        f"home, {count} orientations leave {narrow} in place of {wide}: the condition number of the force step is "
        f"{narrow_condition} in place of {wide_condition}, as weight and bias along z can hardly be told apart.",
        best < 0.85 * first,
        best_many.near(first_many, 0.2),
        narrow > 5.0 * wide,
        narrow_condition > 5.0 * wide_condition,
    )


def _mass(of: str, done: Calibration) -> Measured:
    return Measured(f"predicted error of the mass by {of}", 1e3 * predicted_error(done, "mass"), "g")


def _condition(done: Calibration) -> float:
    return float(done.summary("measures", "condition_force")["median"])


def _refused() -> Table:
    def attempt(vectors: list[FloatArray]) -> str:
        orientations = np.array([pin.exp3(vector) for vector in vectors])
        return refusal(lambda: check_orientations(orientations))

    attempts = {
        "2 orientations": [np.zeros(3), np.array([1.0, 0.0, 0.0])],
        "4 orientations turned about the vertical": [np.array([0.0, 0.0, k * np.pi / 2]) for k in range(4)],
        "4 orientations tilted by 10 deg all around": [
            np.radians(10.0) * np.array([np.cos(a), np.sin(a), 0.0]) for a in np.arange(4) * np.pi / 2
        ],
    }
    return Table(
        "Sets of orientations that are refused, and why.",
        ["set", "reason given"],
        [[name, attempt(vectors)] for name, vectors in attempts.items()],
    )
