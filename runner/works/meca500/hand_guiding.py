"""Hand-guiding: the tool led by a hand, on an arm without springs along its axes."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Curves, Panel, Section, Series, Text
from runner.reporting.figures import AXES, columns, origin, playback
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.run_values import clock
from runner.store import Run
from runner.works.meca500.signals import turns, wrenches

_PEAK_OVER_MEAN = 1.875  # speed of a quintic from rest to rest
_CASES = {"hand/ideal": "exact sensor and joints", "hand/lab": "Mini40 and joint servos"}


def hand_guiding_section(runs: Mapping[str, Run]) -> Section:
    """Return the tool led by a hand, played back, and the force that it takes."""
    ideal = runs["hand/ideal"]
    environment, controller = ideal.config["environment"], ideal.config["controller"]
    travel = float(np.linalg.norm(environment["travel"]))
    return Section(
        "Hand-guiding",
        (
            Text(
                f"$K = 0$ along the axes, so that the tool stays where it is left; $B = {controller['damping'][0]:g}$ "
                f"N s/m. A hand takes hold of the tip by a spring of {environment['stiffness']:g} N/m and leads it "
                f"{1e3 * travel:.3g} mm away within {environment['duration']:g} s, from rest to rest, and lets it "
                "stand."
            ),
            playback(ideal, "The tool follows the hand."),
            _curves(runs),
            guiding_finding(**guiding_values(runs)),
        ),
    )


def guiding_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on hand-guiding is about."""
    ideal, lab = (runs[name] for name in _CASES)
    environment, damping = ideal.config["environment"], float(ideal.config["controller"]["damping"][0])
    travel = float(np.linalg.norm(environment["travel"]))
    damped = _PEAK_OVER_MEAN * travel / float(environment["duration"]) * damping
    return {
        "travel": Measured("way of the hand", travel, "m"),
        "damped": Measured("force of the damping at the hand's peak speed", damped, "N"),
        "pull": Measured("largest pull of the hand", _peak(ideal), "N"),
        "left": Measured("distance at the end from where the hand wants it", left_at_end(ideal), "m"),
        "turned": Measured("largest turn of the tool", _turned(ideal), "rad"),
        "lab_pull": Measured("largest pull with a Mini40 and joint servos", _peak(lab), "N"),
        "lab_left": Measured("distance at the end with a Mini40 and joint servos", left_at_end(lab), "m"),
        "lab_turned": Measured("largest turn with a Mini40 and joint servos", 1e3 * _turned(lab), "mrad"),
    }


def guiding_finding(
    travel: Measured,
    damped: Measured,
    pull: Measured,
    left: Measured,
    turned: Measured,
    lab_pull: Measured,
    lab_left: Measured,
    lab_turned: Measured,
) -> Finding:
    """Return how the tool follows a hand."""
    return finding(
        "The tool follows the hand with little more force than its damping needs, and stays where it is left",
        f"The hand pulls with at most {pull}; damping at the hand's peak speed alone is {damped}. After a way of "
        f"{travel} the tip is {left} from where the hand wants it, and has turned by {turned.shown} at most. With the "
        f"noise of a Mini40 and joint servos it is {lab_pull}, {lab_left} and {lab_turned}.",
        pull.near(damped, 0.1),
        left < 1e-3 * travel,
        turned < ROUNDING,
        lab_pull.near(damped, 0.1),
        lab_left < 0.01 * travel,
        lab_turned < 2.0,
    )


def _peak(run: Run) -> float:
    return float(np.linalg.norm(wrenches(run, "external")[:, :3], axis=1).max())


def left_at_end(run: Run) -> float:
    """Return the tip's distance at the end from where the hand wants it, in m."""
    tip = columns(run.trace, "tip")
    return float(np.linalg.norm(tip[-1] - tip[0] - np.array(run.config["environment"]["travel"])))


def _turned(run: Run) -> float:
    return float(np.linalg.norm(turns(run), axis=1).max())


def _curves(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for name, case in _CASES.items():
        run = runs[name]
        felt = wrenches(run, "felt")
        series = [Series(axis, clock(run), felt[:, index]) for index, axis in enumerate(AXES)]
        panels.append(Panel(f"Force felt, {case}", "time (s)", "force (N)", series))
    for name, case in _CASES.items():
        run = runs[name]
        tip = columns(run.trace, "tip")
        series = [Series(axis, clock(run), 1e3 * (tip - tip[0])[:, index]) for index, axis in enumerate(AXES)]
        panels.append(Panel(f"Tip, {case}", "time (s)", "displacement (mm)", series))
    return Curves("Force of the hand as it is felt, and the tip's way.", panels, 2, origin(runs["hand/ideal"]))
