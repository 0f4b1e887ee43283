"""Signals, forces, admittance laws, calibration errors and verdicts for the chapters of the Meca500 study."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import pinocchio as pin

from runner.audit.audit import audit
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.quantities import number, quantity, with_powers
from runner.calibration.tool_direction import alignment, alignment_angles
from runner.controllers.force.admittance_filter import Admittance, AdmittanceFilter
from runner.reporting.document import Series, Verdicts
from runner.reporting.equation import EquationVerdict
from runner.reporting.published_claims import Verdict, load_statements
from runner.robots.model import RobotModel
from runner.store import Calibration, Run
from runner.studies.meca500.plan import law_in
from runner.study.claims import judged_statements
from runner.study.measured import ROUNDING, Measured
from runner.study.prose.tables import Column
from runner.study.results import Found, Results, Runs

Calibrations = Results[Any]  # of Calibration
once = lru_cache(maxsize=256)  # of functions of a run, which several chapters call
_STILL = 1e-4  # N, below which a force that swings is rounding


def wrenches(run: Run, signal: str) -> FloatArray:
    """Return a signal such as "felt" at each tick, force in N and moment in N m, shape (T, 6)."""
    return np.hstack([run.vector(f"{signal}_{kind}") for kind in ("force", "moment")])


@once
def turns(run: Run) -> FloatArray:
    """Return the rotation vector of the tip since the first row, along the base's axes, shape (T, 3), in rad."""
    model, rows = run.model, run.joints("q")
    first = model.tip_pose(rows[0])[:3, :3]
    return np.array([pin.log3(model.tip_pose(q)[:3, :3] @ first.T) for q in rows])


def displacement(run: Run) -> FloatArray:
    """Return the tip's translation and rotation since the first row, shape (T, 6), in m and rad."""
    tip = run.vector("tip")
    return np.hstack([tip - tip[0], turns(run)])


def law_of(run: Run) -> Admittance:
    """Return the law of a run's axes."""
    return law_in(run.config)


def loads_of(run: Run) -> FloatArray:
    """Return force and moment that push a run's tip, shape (6,), in N and N m."""
    return np.array([*run.config["environment"]["force"], *run.config["environment"]["moment"]], dtype=float)


def added_inertia(run: Run, shorter: float = 1.0) -> FloatArray:
    """Return h D + h^2 K of each servo, in kg m^2, with a period h so many times that of the run."""
    servo = run.config["plant"]["servo"]
    K, period = float(servo["stiffness"]), shorter * float(servo["period"])
    inertia = np.diagonal(run.model.mass_matrix(np.array(run.config["robot"]["home"])))
    return np.asarray(2.0 * period * float(servo["damping_ratio"]) * np.sqrt(K * inertia) + period**2 * K)


def servo_compliance(run: Run) -> FloatArray:
    r"""Return the tip's displacement at rest per unit of load, along and about the base's axes, shape (6, 6).

    The servos evaluate spring and damper with the acceleration that they would bring an unloaded arm. A load that holds
    the arm still stops that acceleration, and at the first posture of a run there is left

    .. math:: K_e = M (M + h D + h^2 K)^{-1} K, \qquad C = J K_e^{-1} J^T
    """
    model, q = run.model, run.joints("q")[0]
    M, J = model.mass_matrix(q), model.tip_jacobian(q)
    kept = M @ np.linalg.inv(M + np.diag(added_inertia(run))) * float(run.config["plant"]["servo"]["stiffness"])
    return J @ np.linalg.solve(kept, J.T)


def bounces(run: Run) -> bool:
    """Return True if contact is observed to be unstable.

    It is unstable if in the last third of a run the tip leaves the wall, or if the force swings more widely than in
    the third before.
    """
    force = -wrenches(run, "external")[:, 0]
    third = len(force) // 3
    before, last = force[third : 2 * third], force[-third:]
    return bool(last.min() <= 0.0 or np.ptp(last) > max(np.ptp(before), _STILL))


def vanishing(what: Callable[..., float], digits: int = 3, factor: float = 1.0) -> Callable[..., str]:
    """Return the text of so many times a number in which what is below ROUNDING counts as none."""
    return lambda *runs: number(factor * what(*runs), digits, rounding=factor * ROUNDING)


def percent(what: Callable[..., float], digits: int = 3) -> Callable[..., str]:
    """Return the text of a share in per cent."""
    return lambda *runs: quantity(100.0 * what(*runs), "%", digits)


def degrees(angle: float) -> float:
    """Return an angle of so many rad in degrees."""
    return float(np.degrees(angle))


def fit(values: FloatArray, errors: FloatArray) -> float:
    """Return the power of the values with which errors grow, by least squares of the logarithms."""
    return float(np.polyfit(np.log(values), np.log(errors), 1)[0])


def flange_of(calibration: Calibration) -> RobotModel:
    """Return the arm that was calibrated, with its flange as tip."""
    return RobotModel(calibration.urdf, calibration.provenance["flange"], calibration.config["gravity"])


def error(*names: str) -> Callable[[Calibration], float]:
    """Return the root mean square over the repetitions of the length of an error, of named components or of all."""
    return lambda done: float(np.sqrt(np.mean(np.sum(done.values("errors", *names) ** 2, axis=1))))


def predicted(*names: str) -> Callable[[Calibration], float]:
    """Return the standard deviation of `error` by the covariances."""
    return lambda done: float(np.sqrt(np.mean(np.sum(done.values("deviations", *names) ** 2, axis=1))))


def largest_error(done: Calibration) -> float:
    """Return the largest error of all repetitions."""
    return float(np.abs(done.values("errors")).max())


def measure(name: str) -> Callable[[Calibration], float]:
    """Return the median of a measure, such as a condition number."""
    return lambda done: float(done.summary("measures", name)["median"])


def nees_of(done: Calibration) -> dict[str, str]:
    """Return the mean normalised error squared, its band, and whether it lies there; dashes without noise."""
    found = done.consistency
    if found is None:
        return dict.fromkeys(("mean", "band", "inside"), "–")
    band = f"{number(found['lower'])} to {number(found['upper'])}"
    return {"mean": number(found["mean"]), "band": band, "inside": "yes" if found["holds"] else "no"}


def varied(words: Mapping[str, str]) -> Column:
    """Return a column with words for the axis that a row is about."""
    return Column("varied", lambda _, row: words[next(iter(row.levels))])


def amount(factors: Mapping[str, float]) -> Column:
    """Return a column with the level of the axis that a row is about, multiplied by the factor of this axis."""

    def text(_: Runs, row: Found) -> str:
        ((axis, level),) = row.levels.items()
        return number(factors.get(axis, 1.0) * float(level))

    return Column("value", text)


def consistency(calibrations: Calibrations, kind: str) -> dict[str, Measured]:
    """Return in how many calibrations of a kind the errors are as large as predicted."""
    all_of_kind = {done.hash: done.consistency for name, done in calibrations.items() if name.startswith(f"{kind}/")}
    found = [each for each in all_of_kind.values() if each is not None]
    inside = sum(bool(each["holds"]) for each in found)
    level = 100.0 * min(each["level"] for each in found)
    return {
        "inside": Measured("calibrations with NEES inside its band", inside),
        "number": Measured("calibrations", len(found)),
        "outside": Measured("calibrations with NEES outside its band", len(found) - inside),
        "level": Measured("band", level, "%"),
        "chance": Measured("what chance puts outside", 100.0 - level, "%"),
    }


def refusal(attempt: Callable[[], object]) -> str:
    """Return why something is refused by a ConfigError, the config's key left out."""
    try:
        attempt()
    except ConfigError as problem:
        return with_powers(problem.problems[0].partition(": ")[2])
    return "not refused"


def filtered_turn(run: Run) -> float:
    """Return the largest rotation that the law makes of the wrenches felt in a run, in rad."""
    law = AdmittanceFilter(law_of(run), float(run.config["controller"]["period"]))
    largest = 0.0
    for wrench in wrenches(run, "felt"):
        law.step(wrench)
        largest = max(largest, float(np.linalg.norm(law.displacement[3:])))
    return largest


def as_felt(run: Run) -> FloatArray:
    """Return the wall's push as it is felt, shape (T,), in N; what is felt is the reading of a tick before."""
    return np.append(-wrenches(run, "felt")[1:, 0], np.nan)


def forces(run: Run) -> dict[str, float]:
    """Return the forces against the way into a wall, in N, how far in the spring's rest is led, in m, and shares.

    The force felt at the end is compared with the wall's stiffness times the depth of the tip, and against the springs
    of law, wall and servos in series: off_depth and off_series say by which share it is above them.
    """
    wall, trajectory = run.config["environment"], run.config["trajectory"]
    begin = float(trajectory["start"][0] + wall["distance"])
    way, stiffness = float(trajectory["goal"][0]) - begin, float(wall["stiffness"])
    felt, peak = float(-wrenches(run, "felt")[-1, 0]), float(-wrenches(run, "external")[:, 0].min())
    soft = float(servo_compliance(run)[0, 0]) if run.config["plant"]["kind"] != "kinematic" else 0.0
    series = way / (1.0 / float(law_of(run).stiffness[0]) + 1.0 / stiffness + soft)
    off_depth = felt / (stiffness * (float(run.vector("tip")[-1, 0]) - begin)) - 1.0
    return {"way": way, "felt": felt, "peak": peak, "first": peak / felt, "series": series, "off_depth": off_depth,
            "off_series": felt / series - 1.0}  # fmt: skip


_PEAK_OVER_MEAN = 1.875  # speed of a quintic from rest to rest


def guided(run: Run) -> dict[str, float]:
    """Return the hand's way and how far from its end the tip is left, in m, and the damping at its peak speed, in N."""
    hand, tip = run.config["environment"], run.vector("tip")
    way = float(np.linalg.norm(hand["displacement"]))
    damping = _PEAK_OVER_MEAN * way / float(hand["duration"]) * float(run.config["controller"]["damping"][0])
    return {
        "way": way,
        "left": float(np.linalg.norm(tip[-1] - tip[0] - np.array(hand["displacement"]))),
        "damping": damping,
    }


def joint_speeds(runs: Runs, run: str) -> list[Series]:
    """Return the speeds of joints 1, 2, 3 and 5 as shares of their limits."""
    shares = runs[run].joints("dq") / runs[run].model.velocity_limits
    return [Series(f"joint {joint}", runs[run].t, shares[:, joint - 1]) for joint in (1, 2, 3, 5)]


def limits(run: Run) -> dict[str, Any]:
    """Return a run's distances from limits, and its warnings.

    margin to a position limit in rad, below zero beyond it; as shares of the speed limit the largest speed and change
    of speed from tick to tick; the smallest singular value of the tip's Jacobian over that at the start.
    """
    model, q = run.model, run.joints("q")
    speeds = run.joints("dq") / model.velocity_limits
    singular = [np.linalg.svd(model.tip_jacobian(own), compute_uv=False)[-1] for own in q[::10]]
    said = "; ".join(map(str, run.provenance["warnings"]))
    return {
        "margin": float(model.limit_margins(q).min()),
        "speed": float(np.abs(speeds).max()),
        "change": float(np.abs(np.diff(speeds, axis=0)).max()),
        "singular": float(min(singular) / singular[0]),
        "said": said.replace("the posture, singular or nearly so", "a posture at or near a singularity").replace(
            " has held the tool back, first at t =", " from"
        ),
        "told": "has held the tool back" in said,
    }


_INSERTED = 0.02  # m, about the length of a root canal file


def direction(calibrations: Calibrations, worst: str) -> dict[str, Measured]:
    """Return the example's true angles, the angles off its direction by equation 7, and insertions by the worst."""
    base = calibrations["tool_direction/base"]
    t = np.array(base.config["calibration"]["direction"])
    t /= np.linalg.norm(t)
    R = alignment(*alignment_angles(t))
    off = [float(np.degrees(np.arccos(np.clip(along @ t, -1.0, 1.0)))) for along in (R.T[:, 2], R[:, 2])]
    return {
        "alpha": Measured("true alpha", float(np.degrees(base.truth["alpha"])), "°"),
        "beta": Measured("true beta", float(np.degrees(base.truth["beta"])), "°"),
        "printed": Measured("angle to the tool, read as printed", off[0], "°"),
        "described": Measured("angle to the tool, read as described", off[1], "°"),
        "inserted": Measured("way of insertion", 1e3 * _INSERTED, "mm"),
        "aside": Measured("how far the insertion ends aside", 1e6 * _INSERTED * error()(calibrations[worst]), "µm"),
    }


_SAMPLES = 200
_LEGEND = (
    "A statement matches when every condition of the findings on it is met, and differs when one is not. It is "
    "undecided when nothing here measures it. Equations are correct or wrong as printed by the audit."
)


def verdict(*holds: bool) -> Verdict:
    """Return the verdict on a statement that is true where all of some findings hold."""
    return "matches" if all(holds) else "differs"


def audited(equation: str) -> EquationVerdict:
    """Return the audit's verdict on an equation."""
    return next(each.verdict for each in audit("meca500", _SAMPLES) if each.entry.id == equation)


def statements(caption: str, checked: Mapping[str, tuple[Verdict | EquationVerdict, str]]) -> Verdicts:
    """Return each statement with its verdict and what was measured, by its name."""
    return Verdicts(caption, judged_statements(load_statements("meca500"), checked), _LEGEND)
