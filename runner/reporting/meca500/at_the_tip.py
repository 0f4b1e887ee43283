"""Work at the tool tip: what a pure force through the tip turns, and where it is taken to act."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.admittance_filter import AdmittanceFilter
from runner.reporting.document import Formula, Notice, Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.meca500.plan import TIP_CASES
from runner.reporting.meca500.signals import turns, wrenches
from runner.reporting.meca500.step_response import law_of
from runner.reporting.quantities import number, quantity
from runner.store import Run


def at_the_tip_section(runs: Mapping[str, Run]) -> Section:
    """Return rotations under a force through the tip, by where the wrench is taken to act."""
    cases = {case: runs[f"tip/{case}"] for case in TIP_CASES}
    rows = [
        [
            case,
            number(float(np.abs(wrenches(run, "felt")[:, 3:]).max())),
            number(filtered_turn(run)) if case != "at the flange" else "–",
            number(tool_turn(run)),
        ]
        for case, run in cases.items()
    ]
    tip, flange, servo, noisy = cases.values()
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
            Notice(
                "finding",
                "A pure force through the tip turns nothing",
                f"Through transform and filter it turns {number(filtered_turn(tip))} rad, and the tool itself "
                f"{number(tool_turn(tip))} rad. Taken at the flange the same force turns the tool by "
                f"{quantity(tool_turn(flange), 'rad')}. Joint servos do not hold orientation under a force: they add "
                f"{quantity(tool_turn(servo), 'rad')} by their springs, with no rotation asked for; the noise of a "
                f"Mini40 adds {quantity(tool_turn(noisy), 'rad')}.",
            ),
        ),
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
