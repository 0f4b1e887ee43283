"""Hand-guiding: the tool led by a hand, on an arm without springs along its axes."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Curves, Notice, Panel, Section, Series, Text
from runner.reporting.figures import AXES, columns, origin, playback
from runner.reporting.meca500.signals import turns, wrenches
from runner.reporting.quantities import quantity
from runner.reporting.run_values import clock
from runner.store import Run

_CASES = {"hand/ideal": "exact sensor and joints", "hand/lab": "Mini40 and joint servos"}


def hand_guiding_section(runs: Mapping[str, Run]) -> Section:
    """Return the tool led by a hand, played back, and the force that it takes."""
    ideal, lab = (runs[name] for name in _CASES)
    environment, controller = ideal.config["environment"], ideal.config["controller"]
    travel = float(np.linalg.norm(environment["travel"]))
    mean_speed = travel / float(environment["duration"])
    damped = 1.875 * mean_speed * float(controller["damping"][0])
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
            Notice(
                "finding",
                "It comes along, takes little force, and stays",
                f"The hand pulls with at most {quantity(_peak(ideal), 'N')}; damping at the hand's peak speed alone is "
                f"{quantity(damped, 'N')}. At the end the tip is {quantity(left_at_end(ideal), 'm')} from where the "
                f"hand wants it, and has turned by {quantity(_turned(ideal), 'rad')} at most. With the noise of a "
                f"Mini40 and joint servos: {quantity(_peak(lab), 'N')}, {quantity(left_at_end(lab), 'm')} and "
                f"{quantity(_turned(lab), 'rad')}.",
            ),
        ),
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
