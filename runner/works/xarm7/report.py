"""The whole xArm7 report, from its stored runs."""

from collections.abc import Mapping

from runner.reporting.checklist import load_checklist
from runner.reporting.document import Document, Section
from runner.reporting.work_report import parts, work_document
from runner.store import Calibration, Run
from runner.works.xarm7.caveats import EXPECTED
from runner.works.xarm7.claims import claims_section
from runner.works.xarm7.kinematics import kinematics_section
from runner.works.xarm7.null_space import null_space_section
from runner.works.xarm7.payload import payload_section
from runner.works.xarm7.plants import plants_section
from runner.works.xarm7.rates import rates_section
from runner.works.xarm7.servo import servo_section
from runner.works.xarm7.seven_joints import seven_joints_section
from runner.works.xarm7.source import source_section
from runner.works.xarm7.three_joints import three_joints_section
from runner.works.xarm7.torque_level import torque_level_section
from runner.works.xarm7.why_it_failed import why_it_failed_section


def document(runs: Mapping[str, Run], calibrations: Mapping[str, Calibration]) -> Document:
    """Return the report on the xArm7 path-planning report.

    Args:
        runs: The stored runs of `plan()`, by name.
        calibrations: None: the work has none.
    """
    return work_document(
        title="Robotic Manipulator: Path Planning",
        subtitle="The xArm7 report (National Technical University of Athens, 2024), reproduced and made to work",
        abstract=(
            "A UFACTORY xArm7 moves its flange between two points 40 cm apart. The report's first part, three "
            "joints by inverse kinematics in closed form, is made again, and its printed formulas are held against "
            "the arm's model. Of its second part, all seven joints by a pseudo-inverse, the report says that the "
            "code is not functional: here its formulas are taken one by one, and another law is run in their place. "
            "What the report could not show comes after: the joints to spare, the rate of commands, the servos' "
            "stiffness, payloads, and joint torques."
        ),
        chapters=parts(
            runs,
            claims_section,
            source_section,
            kinematics_section,
            three_joints_section,
            why_it_failed_section,
            seven_joints_section,
            _beyond,
            plants_section,
        ),
        behind=(
            f"{len({run.hash for run in runs.values()})} runs lie behind this report, each stored with its "
            "config, trace and metrics under outputs/runs."
        ),
        runs=runs,
        expected=EXPECTED,
        checklist=load_checklist("xarm7").section,
    )


def _beyond(runs: Mapping[str, Run]) -> Section:
    return Section(
        "What the report could not show",
        sections=parts(
            runs,
            null_space_section,
            rates_section,
            servo_section,
            payload_section,
            torque_level_section,
        ),
    )
