"""Wrist sensor: joint reaction of the plant compared with the tool's rigid-body balance, and noise of a Mini40."""

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from runner.base.arrays import FloatArray
from runner.controllers.force.admittance_filter import AXES, discretise
from runner.papers.studies.meca500.figures import displacement, wrenches
from runner.papers.studies.meca500.plan import law_in
from runner.papers.study.results import Runs, matching_runs
from runner.sensing.force_torque import AXES as SENSOR_AXES
from runner.sensing.force_torque import ForceTorqueConfig
from runner.sensing.wrench import inverse_wrench_transform
from runner.store import Run


def parting(run: Run) -> FloatArray:
    """Return the distance between reaction and balance at each tick, shape (T,), in N; the first reaction is none."""
    return np.append(np.nan, np.linalg.norm((wrenches(run, "load") - wrenches(run, "reaction"))[1:, :3], axis=1))


def moment_parting(run: Run) -> FloatArray:
    """Return the moments of the balance less those of the reaction, after the first tick, shape (T - 1, 3), in N m."""
    return (run.vector("load_moment") - run.vector("reaction_moment"))[1:]


def noise(runs: Runs, pattern: str) -> list[list[str | float]]:
    """Return the residuals of readings at rest, less bias and true load, with noise and quantisation, by axis."""
    at_rest = [each.run for each in matching_runs(runs, pattern)]
    sensor = ForceTorqueConfig.model_validate(at_rest[0].config["wrist_sensor"])
    seen = inverse_wrench_transform(sensor.pose)
    left = np.vstack([wrenches(run, "reading") - wrenches(run, "load") @ seen.T - sensor.bias for run in at_rest])
    residuals, theories = np.sqrt(np.mean(left**2, axis=0)), np.sqrt(sensor.reading_variance(1))
    return [
        [axis, own, theory, own / theory] for axis, own, theory in zip(SENSOR_AXES, residuals, theories, strict=True)
    ]


def shaken(runs: Runs, name: str) -> list[list[str | float]]:
    """Return the standard deviations of felt wrench and tip at rest, in µm and µrad, and those of the sampled law."""
    run = runs[name]
    Phi, Gamma = discretise(law_in(run.config), float(run.config["controller"]["period"]))
    settled = slice(len(run.t) // 6, None)
    felt, tip = wrenches(run, "felt")[settled].std(axis=0), displacement(run)[settled].std(axis=0)
    expected = [
        solve_discrete_lyapunov(one, np.outer(other, other))[0, 0] for one, other in zip(Phi, Gamma, strict=True)
    ]
    return [list(row) for row in zip(AXES, felt, 1e6 * tip, 1e6 * felt * np.sqrt(expected), strict=True)]
