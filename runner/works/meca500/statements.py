"""What the report claims in words, and whether it holds."""

from collections.abc import Mapping

from runner.audit.audit import audit
from runner.claims import load_statements
from runner.reporting.claim import EquationVerdict, StatementVerdict
from runner.reporting.claims import statement_blocks
from runner.reporting.document import Section, Text
from runner.reporting.findings import Finding
from runner.store import Run
from runner.works.meca500.at_the_tip import tip_finding, tip_values
from runner.works.meca500.contact import contact_finding, contact_values
from runner.works.meca500.hand_guiding import guiding_values
from runner.works.meca500.limits import limits_values
from runner.works.meca500.servo_walls import servo_wall_finding, servo_wall_values
from runner.works.meca500.stability_map import ideal_wall_finding, ideal_wall_values
from runner.works.meca500.step_response import (
    ideal_step_finding,
    ideal_step_values,
    servo_step_finding,
    servo_step_values,
)

_SAMPLES = 200


def statements_section(runs: Mapping[str, Run]) -> Section:
    """Return each statement with what was measured, and what was asked of the simulation beside it."""
    step, servo = ideal_step_values(runs), servo_step_values(runs)
    tip, wall = tip_values(runs), contact_values(runs)
    ideal, behind = ideal_wall_values(runs), servo_wall_values(runs)
    hand, limits = guiding_values(runs), limits_values(runs)
    equations = {each.entry.id: each.verdict for each in audit("meca500", _SAMPLES)}
    judged: dict[str, tuple[StatementVerdict | EquationVerdict, str]] = {
        "spring-mass-damper": (
            _verdict(ideal_step_finding(**step), servo_step_finding(**servo)),
            f"within {step['fast']} of the peak on all axes at 1 ms, {step['slow']} at {step['period']}; joint servos "
            f"add up to {servo['fast']}",
        ),
        "end effector": (
            _verdict(tip_finding(**tip)),
            f"a force through the tip turns the law by {tip['law'].shown} and the tool by {tip['tool'].shown}; taken "
            f"at the flange {tip['flange']}",
        ),
        "safety": (
            "not testable here",
            f"guided by hand the tool ends {hand['lab_left']} from where it was led; least margin to a joint's limit: "
            f"{limits['margin'].shown}",
        ),
        "contact": (
            _verdict(contact_finding(**wall), ideal_wall_finding(**ideal), servo_wall_finding(**behind)),
            f"the force on walls is read within {wall['reading']}; on ideal joints {ideal['right']} of "
            f"{ideal['count']} runs bounce or not as predicted, behind servos {behind['right']} of {behind['count']}",
        ),
        "axis angle": (
            equations["meca500-turn"],
            "the printed sum of angles along the axes, by which the axis angle is to be found",
        ),
        "wrench": (equations["meca500-wrench"], "the final matrix"),
    }
    return Section(
        "What it claims, and whether it holds",
        (
            Text(
                "The report claims in words; it has no table of results. Here are its statements on control, with what "
                "was measured; those on calibration have sections of their own. A statement holds where every "
                "condition of the findings on it, in the sections below, is met; it no longer holds where one fails. "
                "What the simulation has no measure for is not testable here. On equations stand the words of the "
                "audit: an equation is correct, correct after repair of a damaged text, or wrong as printed."
            ),
            *statement_blocks(load_statements("meca500"), judged),
        ),
    )


def _verdict(*findings: Finding) -> StatementVerdict:
    return "holds" if all(each.holds for each in findings) else "no longer holds"
