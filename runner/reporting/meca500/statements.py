"""What the report claims in words, and whether it holds."""

from collections.abc import Mapping

from runner.controllers.admittance_filter import AXES
from runner.reporting.document import Section, Table, Text
from runner.reporting.figures import origin
from runner.reporting.meca500.at_the_tip import filtered_turn, tool_turn
from runner.reporting.meca500.contact import reading_error
from runner.reporting.meca500.hand_guiding import left_at_end
from runner.reporting.meca500.limits import smallest_margin
from runner.reporting.meca500.plan import LIMITS, PLANTS, STEP_CASES, WALLS
from runner.reporting.meca500.stability_map import agreement
from runner.reporting.meca500.step_response import step_error
from runner.reporting.quantities import number, quantity
from runner.store import Run


def statements_section(runs: Mapping[str, Run]) -> Section:
    """Return each statement with what was measured, and what was asked of the simulation beside it."""
    error = {case: max(step_error(runs[f"step/{case}/{axis}"], axis) for axis in AXES) for case in STEP_CASES}
    walls = max(reading_error(runs[f"wall/{plant}/{k:g}"]) for plant in PLANTS for k in WALLS)
    right, count = agreement(runs)
    margin = min(smallest_margin(runs[f"limit/{name}"]) for name in LIMITS)
    tip = runs["tip/at the tip"]
    rows = [
        ["5", "Admittance control makes the robot move like a spring-mass-damper system",
         f"holds: within {number(error['kinematic, 1 ms'])} of the peak on all axes at 1 ms, and "
         f"{_percent(error['kinematic, 16.7 ms'])} at 16.7 ms; joint servos add {_percent(error['servo, 1 ms'])}"],
        ["5", "It is triggered by the end effector on the sensor instead of each wrist of the arm",
         f"holds: a force through the tip turns the law by {number(filtered_turn(tip))} rad and the tool by "
         f"{number(tool_turn(tip))} rad; taken at the flange {quantity(tool_turn(runs['tip/at the flange']), 'rad')}"],
        ["5", "It allows an arm to cooperate with a human safely",
         f"guided by hand the tool stays {quantity(left_at_end(runs['hand/lab']), 'm')} from where it was left; no "
         f"joint passes a limit (least margin {number(margin)} rad)"],
        ["5", "Forces can be mapped into positions (no word on contact)",
         f"the force on walls is read within {number(walls)}; a wall too stiff for the sample time makes it "
         f"bounce, as predicted in {right} of {count} runs"],
        ["5", "Torques are related to the axis angle by eq. (8)",
         "holds about one axis; about several the printed sum of angles is no rotation, ours is"],
        ["6", "The wrench is moved from the sensor to the tool by two matrices", "holds for the final matrix"],
    ]  # fmt: skip
    return Section(
        "What it claims, and whether it holds",
        (
            Text(
                "The report claims in words; it has no table of results. Here are its statements on control, with what "
                "was measured; those on calibration have sections of their own."
            ),
            Table("Statements and findings.", ["section", "statement", "found"], rows, origin=origin(tip)),
        ),
    )


def _percent(share: float) -> str:
    return f"{number(100.0 * share, 2)} %"
