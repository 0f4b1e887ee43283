"""Wrist sensor: joint reaction of the plant compared with the tool's rigid-body balance, and noise of a Mini40."""

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.controllers.force.admittance_filter import AXES, discretise
from runner.reporting.document import Series, Table
from runner.reporting.figures import origin
from runner.reporting.table import numbers
from runner.sensing.force_torque import AXES as SENSOR_AXES
from runner.sensing.force_torque import ForceTorqueConfig
from runner.sensing.wrench import wrench_transform
from runner.store import Run
from runner.studies.meca500.figures import displacement, fit, law_of, wrenches
from runner.study.measured import Measured
from runner.study.results import Runs, found
from runner.study.run_values import values


def reaction(run: Run) -> dict[str, float]:
    """Return the tool's weight, how far the reaction at the end is off it, in N, and how far it is off the balance.

    The reaction differs from the tool's rigid-body balance by force in motion, in N, and its moment along an axis
    by moment, in N m; force_at_rest and moment_at_rest are the largest differences along an axis at the end.
    """
    apart, tool = _apart(run), run.config["robot"]["tool"]
    weight = float(tool["mass"]) * float(run.config["gravity"])
    return {
        "force": float(np.linalg.norm(apart[1:, :3], axis=1).max()),  # the first reaction follows the first step
        "moment": float(apart[1:, 3:].max()),
        "force_at_rest": float(apart[-1, :3].max()),
        "moment_at_rest": float(apart[-1, 3:].max()),
        "weight": weight,
        "weighing": abs(float(np.linalg.norm(wrenches(run, "reaction")[-1, :3])) - weight),
    }


def power(runs: Runs, words: str, pattern: str) -> Measured:
    """Return the power of the peak joint speed with which the forces part, by a line through the logarithms."""
    swings = [each.run for each in found(runs, pattern)]
    forces = np.array([reaction(run)["force"] for run in swings])
    return Measured(words, fit(values(swings, "peak_joint_speed"), forces))


def parting(runs: Runs, pattern: str) -> list[Series]:
    """Return the distance between the forces over the speed of the fastest joint, tick by tick."""
    series = []
    for each in found(runs, pattern):
        speed = np.abs(each.run.joints("dq")).max(axis=1)[1:]
        apart = np.linalg.norm(_apart(each.run)[1:, :3], axis=1)
        moving = (speed > 1e-2) & (apart > 0.0)
        series.append(Series(f"{float(each.levels['lap']):g} s", speed[moving], apart[moving], "points"))
    return series


def noise(runs: Runs, pattern: str) -> Table:
    """Return the residuals of readings at rest, less bias and true load, with noise and quantisation."""
    at_rest = [each.run for each in found(runs, pattern)]
    sensor = ForceTorqueConfig.model_validate(at_rest[0].config["wrist_sensor"])
    seen = np.linalg.inv(wrench_transform(sensor.pose))
    left = np.vstack([wrenches(run, "reading") - wrenches(run, "load") @ seen.T - sensor.bias for run in at_rest])
    rows = [
        [axis, number(float(is_left)), number(float(theory)), f"{is_left / theory:.2f}"]
        for axis, is_left, theory in zip(
            SENSOR_AXES, np.sqrt(np.mean(left**2, axis=0)), np.sqrt(sensor.reading_variance(1)), strict=True
        )
    ]
    ratios = [float(row[3]) for row in rows]
    caption = (
        f"The residual of a Mini40's readings is {min(ratios):.2f} to {max(ratios):.2f} times noise and quantisation; "
        f"{len(left)} readings, in N and N m."
    )
    header = ["axis", *numbers("root mean square", "noise and quantisation", "ratio")]
    return Table(caption, header, rows, origin(at_rest[0]), prose=True)


def shaken(runs: Runs, name: str, caption: str) -> Table:
    """Return the standard deviations of felt wrench and tip at rest, against those of the sampled law."""
    run = runs[name]
    Phi, Gamma = discretise(law_of(run), float(run.config["controller"]["period"]))
    settled = slice(len(run.t) // 6, None)
    felt, tip = wrenches(run, "felt")[settled].std(axis=0), displacement(run)[settled].std(axis=0)
    rows = []
    for index, axis in enumerate(AXES):
        variance = solve_discrete_lyapunov(Phi[index], np.outer(Gamma[index], Gamma[index]) * felt[index] ** 2)
        unit = "µm" if index < 3 else "µrad"
        moved = (f"{number(1e6 * float(value))} {unit}" for value in (tip[index], np.sqrt(variance[0, 0])))
        rows.append([axis, number(float(felt[index])), *moved])
    return Table(caption, ["axis", *numbers("felt", "tip", "tip, predicted")], rows, origin(run), prose=True)


def _apart(run: Run) -> FloatArray:
    """Return |load - reaction| of each component at each tick, shape (T, 6)."""
    return np.abs(wrenches(run, "load") - wrenches(run, "reaction"))
