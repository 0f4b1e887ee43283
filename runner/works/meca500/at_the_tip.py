"""Work at the tool tip: what a pure force through the tip turns, and where it is taken to act."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.admittance_filter import AdmittanceFilter
from runner.reporting.document import Formula, Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number
from runner.store import Run
from runner.works.meca500.plan import TIP_CASES
from runner.works.meca500.signals import turns, wrenches
from runner.works.meca500.step_response import law_of


def at_the_tip_section(runs: Mapping[str, Run]) -> Section:
    """Return rotations under a force through the tip, by where the wrench is taken to act."""
    cases = {case: runs[f"tip/{case}"] for case in TIP_CASES}
    rows = [
        [
            case,
            number(float(np.abs(wrenches(run, "felt")[:, 3:]).max()), rounding=ROUNDING),
            number(filtered_turn(run), rounding=ROUNDING) if case != "at the flange" else "–",
            number(tool_turn(run), rounding=ROUNDING),
        ]
        for case, run in cases.items()
    ]
    tip = cases["at the tip"]
    force = tip.config["environment"]["force"]
    return Section(
        "Work at the tool tip",
        (
            Text(
                "The sensor sits at the flange; seen from there a force through the tip has a moment, and a law fed "
                "with it turns the tool. The wrench is therefore brought to the tip first, from frame 1 to frame 2, by"
            ),
            Formula(
                "F_2 = R F_1, quad M_2 = R M_1 + p times (R F_1)",
                "F 2 equals R F 1, M 2 equals R M 1 plus p cross R F 1",
                "section 6",
            ),
            Text(
                f"with $R$ and $p$ the orientation and the origin of frame 1 in frame 2. A force of {force} N, through "
                "the tip and without moment, sets in at rest. The filter's rotation is what the law makes of the felt "
                "moments stored with the run; that of the tool is what the arm does with it."
            ),
            Table(
                "Largest moment felt about the tip, and rotations, under a pure force through the tip.",
                ["wrench taken", "felt moment (N m)", "filter's rotation (rad)", "tool's rotation (rad)"],
                rows,
                (1, 2, 3),
                origin(tip),
            ),
            tip_finding(**tip_values(runs)),
        ),
    )


def tip_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on a force through the tip is about."""
    tip, flange, servo, noisy = (runs[f"tip/{case}"] for case in TIP_CASES)
    return {
        "law": Measured("rotation that the law makes of it", filtered_turn(tip), "rad"),
        "tool": Measured("rotation of the tool", tool_turn(tip), "rad"),
        "flange": Measured("rotation of the tool where the wrench is taken at the flange", tool_turn(flange), "rad"),
        "servo_law": Measured("rotation that the law makes of it on joint servos", filtered_turn(servo), "rad"),
        "servo": Measured("rotation of the tool on joint servos", tool_turn(servo), "rad"),
        "noisy": Measured("rotation of the tool under a Mini40's noise", tool_turn(noisy), "rad"),
    }


def tip_finding(
    law: Measured, tool: Measured, flange: Measured, servo_law: Measured, servo: Measured, noisy: Measured
) -> Finding:
    """Return what a pure force through the tip turns."""
    return finding(
        "A pure force through the tip turns nothing",
        f"Through transform and filter it turns {law.shown}, and the tool itself {tool.shown}. Taken at the flange the "
        f"same force turns the tool by {flange}. Joint servos do not hold orientation under a force: the law asks for "
        f"{servo_law.shown} there, and the tool turns by {servo}, by their springs. The noise of a Mini40 turns it by "
        f"{noisy}.",
        law < ROUNDING,
        tool < ROUNDING,
        flange > 0.01,
        servo > 10.0 * servo_law,
        servo < 0.2 * flange,
        noisy < 0.1 * flange,
        noisy > 1e-7,
    )


def filtered_turn(run: Run) -> float:
    """Return the largest rotation that the law makes of the wrenches felt in a run, in rad."""
    law = AdmittanceFilter(law_of(run), float(run.config["controller"]["period"]))
    largest = 0.0
    for wrench in wrenches(run, "felt"):
        law.step(wrench)
        largest = max(largest, float(np.linalg.norm(law.displacement[3:])))
    return largest


def tool_turn(run: Run) -> float:
    """Return the largest rotation of the tool in a run, in rad."""
    return float(np.linalg.norm(turns(run), axis=1).max())
