"""The wrist's sensor: PyBullet's joint reaction against the tool's rigid-body balance, and a Mini40's noise."""

from collections.abc import Mapping

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from runner.controllers.admittance_filter import AXES, discretise
from runner.reporting.document import Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import median, values
from runner.sensing.force_torque import AXES as SENSOR_AXES
from runner.sensing.force_torque import ForceTorqueConfig
from runner.sensing.wrench import wrench_transform
from runner.store import Run
from runner.works.meca500.plan import ORIENTATIONS, SWINGS
from runner.works.meca500.signals import displacement, wrenches
from runner.works.meca500.step_response import law_of

_MINI40_STEP = 0.005  # N, the finest of a Mini40's forces


def wrist_sensor_section(runs: Mapping[str, Run]) -> Section:
    """Return what the sensor bears at rest and in motion, from two independent sources, and its noise."""
    at_rest = [runs[f"rest/{number}"] for number in range(ORIENTATIONS)]
    tool = at_rest[0].config["robot"]["tool"]
    return Section(
        "What the wrist's sensor feels",
        (
            Text(
                "The load of the sensor is what world and tool put on the flange. PyBullet computes it as the reaction "
                "in the joint that fixes the tool, at its origin. Independently it is the tool's rigid-body balance: "
                "mass times acceleration less gravity, and the change of angular momentum, less what the world does. "
                f"The tool weighs {tool['mass']:g} kg. At rest, under torque control, it is weighed in "
                f"{ORIENTATIONS} postures drawn within the joint limits; moving, it goes around a circle."
            ),
            _motion(runs),
            _curves(runs),
            reaction_finding(**reaction_values(runs)),
            Text(
                "A Mini40's readings have noise and steps. The same orientations, read by it: what is left when its "
                "bias and the true load, seen from its own frame, are taken off, against noise and quantisation "
                "$sqrt(sigma^2 + q^2 / 12)$. And, on the arm at rest under admittance control, what that noise does to "
                "the tip, against the variance $P = Phi P Phi^T + Gamma sigma^2 Gamma^T$ of the sampled law under the "
                "noise that it feels."
            ),
            _noise(at_rest),
            _shaken(runs["noise"]),
        ),
    )


def reaction_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on PyBullet's joint reaction is about."""
    at_rest = [runs[f"rest/{number}"] for number in range(ORIENTATIONS)]
    apart = np.array([_apart(run)[-1] for run in at_rest])
    weight = float(at_rest[0].config["robot"]["tool"]["mass"]) * float(at_rest[0].config["gravity"])
    weighed = np.array([np.linalg.norm(wrenches(run, "reaction")[-1, :3]) for run in at_rest])
    fastest = runs[f"swing/{SWINGS[-1]}"]
    return {
        "count": Measured("orientations at rest", ORIENTATIONS),
        "force": Measured("largest difference of the forces at rest", float(apart[:, :3].max()), "N"),
        "moment": Measured("largest difference of the moments at rest", float(apart[:, 3:].max()), "N m"),
        "weight": Measured("weight of the tool", weight, "N"),
        "weighed": Measured("largest error of the weight", float(np.abs(weighed - weight).max()), "N"),
        "power": Measured("power of the joint speed with which the forces part", _power(runs)),
        "moving": Measured("largest difference of the forces in motion", _largest(fastest), "N"),
        "speed": Measured("peak joint speed", median(fastest, "peak_joint_speed"), "rad/s"),
        "fine": Measured("largest difference with half the step", _largest(runs["swing/fine"]), "N"),
    }


def reaction_finding(
    count: Measured,
    force: Measured,
    moment: Measured,
    weight: Measured,
    weighed: Measured,
    power: Measured,
    moving: Measured,
    speed: Measured,
    fine: Measured,
) -> Finding:
    """Return where PyBullet's joint reaction is the tool's balance, and where it is not."""
    return finding(
        "At rest the reaction is exact; in motion it is wrong by a term that grows with the speed",
        f"In all {count} orientations reaction and balance differ by {force.shown} in force and {moment.shown} in "
        f"moment, and the tool's weight of {weight} is found with an error of {weighed.shown}. In motion they part, "
        f"with the power {power} of the peak joint speed, up to {moving} at {speed}. It is no error of the step: half "
        f"the step leaves {fine}. The runs' sensor therefore takes the balance, from the true motion.",
        force < ROUNDING,
        moment < ROUNDING,
        weighed < ROUNDING,
        power > 2.0,
        power < 3.0,
        moving > 0.01,
        speed > 1.0,
        fine.near(moving, 0.2),
        weight > 1.0,
    )


def _apart(run: Run) -> FloatArray:
    """Return |load - reaction| of each component at each tick, shape (T, 6)."""
    difference: FloatArray = np.abs(wrenches(run, "load") - wrenches(run, "reaction"))
    return difference


def _largest(run: Run) -> float:
    return float(np.linalg.norm(_apart(run)[1:, :3], axis=1).max())  # there is no reaction before the first step


def _power(runs: Mapping[str, Run]) -> float:
    """Return the power of the peak joint speed with which the forces part, by a line through the logarithms."""
    swings = [runs[f"swing/{duration}"] for duration in SWINGS]
    speeds, forces = values(swings, "peak_joint_speed"), np.array([_largest(run) for run in swings])
    return float(np.polyfit(np.log(speeds), np.log(forces), 1)[0])


def _motion(runs: Mapping[str, Run]) -> Table:
    rows = []
    for duration in SWINGS:
        run = runs[f"swing/{duration}"]
        speed, moment = number(median(run, "peak_joint_speed")), number(float(_apart(run)[1:, 3:].max()))
        rows.append([f"{duration:g}", speed, number(_largest(run)), moment])
    return Table(
        "Joint reaction against rigid-body balance, around a circle of 30 mm radius.",
        ["time around (s)", "peak joint speed (rad/s)", "force apart (N)", "moment apart (N m)"],
        rows,
        tuple(range(4)),
        origin(runs[f"swing/{SWINGS[0]}"]),
    )


def _curves(runs: Mapping[str, Run]) -> Curves:
    series = []
    for duration in SWINGS:
        run = runs[f"swing/{duration}"]
        speed = np.abs(joint_columns(run.trace, "dq")).max(axis=1)[1:]
        apart = np.linalg.norm(_apart(run)[1:, :3], axis=1)
        moving = (speed > 1e-2) & (apart > 0.0)
        series.append(Series(f"{duration:g} s", speed[moving], apart[moving], "points"))
    speeds = np.array([0.01, 4.0])
    series.append(Series("square of the speed", speeds, 1e-2 * speeds**2, "dashed"))
    series.append(Series("step of a Mini40", speeds, np.full(2, _MINI40_STEP), "dotted"))
    panel = Panel(
        "Force apart against the fastest joint's speed, tick by tick",
        "speed of the fastest joint (rad/s)",
        "force apart (N)",
        series,
        x_log=True,
        y_log=True,
        y_range=(1e-7, 1.0),
    )
    return Curves("Joint reaction against rigid-body balance.", (panel,), 1, origin(runs[f"swing/{SWINGS[0]}"]))


def _noise(at_rest: list[Run]) -> Table:
    sensor = ForceTorqueConfig.model_validate(at_rest[0].config["wrist_sensor"])
    seen = np.linalg.inv(wrench_transform(sensor.pose))
    left = np.vstack([wrenches(run, "reading") - wrenches(run, "load") @ seen.T - sensor.bias for run in at_rest])
    expected = np.sqrt(sensor.reading_variance(1))
    rms = np.sqrt(np.mean(left**2, axis=0))
    rows = [
        [axis, number(float(is_left)), number(float(theory)), f"{is_left / theory:.2f}"]
        for axis, is_left, theory in zip(SENSOR_AXES, rms, expected, strict=True)
    ]
    return Table(
        f"Residual of a Mini40's readings, {len(left)} of them, in N and N m.",
        ["axis", "root mean square", "noise and quantisation", "ratio"],
        rows,
        (1, 2, 3),
        origin(at_rest[0]),
    )


def _shaken(run: Run) -> Table:
    law, period = law_of(run), float(run.config["controller"]["period"])
    Phi, Gamma = discretise(law, period)
    settled = slice(len(run.trace) // 6, None)
    felt, moved = wrenches(run, "felt")[settled].std(axis=0), displacement(run)[settled].std(axis=0)
    rows = []
    for index, axis in enumerate(AXES):
        shaken = solve_discrete_lyapunov(Phi[index], np.outer(Gamma[index], Gamma[index]) * felt[index] ** 2)
        unit = "µm" if index < 3 else "µrad"
        predicted = 1e6 * float(np.sqrt(shaken[0, 0]))
        rows.append([axis, number(float(felt[index])), f"{number(1e6 * float(moved[index]))} {unit}",
                     f"{number(predicted)} {unit}"])  # fmt: skip
    return Table(
        "Standard deviations at rest: of the wrench felt at the tip (N and N m), and of the tip.",
        ["axis", "felt", "tip", "tip, predicted"],
        rows,
        (1, 2, 3),
        origin(run),
    )
