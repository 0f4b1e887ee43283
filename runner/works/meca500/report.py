"""The whole Meca500 report, from its stored runs and calibrations."""

from collections.abc import Mapping
from functools import partial

from runner.reporting.checklist import load_checklist
from runner.reporting.document import Document, Section
from runner.reporting.work_report import parts, work_document
from runner.store import Calibration, Run
from runner.works.meca500.at_the_tip import at_the_tip_section
from runner.works.meca500.caveats import EXPECTED
from runner.works.meca500.contact import contact_section
from runner.works.meca500.frequency_response import frequency_response_section
from runner.works.meca500.gravity import gravity_section
from runner.works.meca500.hand_guiding import hand_guiding_section
from runner.works.meca500.inertials import inertials_section
from runner.works.meca500.kinematics import kinematics_section
from runner.works.meca500.limits import limits_section
from runner.works.meca500.plants import plants_section
from runner.works.meca500.source import source_section
from runner.works.meca500.stability_map import stability_map_section
from runner.works.meca500.statements import statements_section
from runner.works.meca500.step_response import step_response_section
from runner.works.meca500.tool_centre_point import tool_centre_point_section
from runner.works.meca500.tool_direction import tool_direction_section
from runner.works.meca500.wrist_sensor import wrist_sensor_section


def document(runs: Mapping[str, Run], calibrations: Mapping[str, Calibration]) -> Document:
    """Return the report on the Meca500's kinematics and force control.

    Args:
        runs: The stored runs of `plan()`, by name.
        calibrations: The stored calibrations of `calibration_jobs()`, by name.
    """
    return work_document(
        title="Meca500: Kinematics and Force Control",
        subtitle="A report on a small arm for dental work, in simulation against known truth",
        abstract=(
            "How a Mecademic Meca500 with a force/torque sensor at its wrist is to learn where its tool is and what it "
            "weighs, and to give way to the world as a mass on a damper and a spring would. The report behind it has "
            "formulas and no results; a simulation has what its laboratory lacked, the truth, and every method is "
            "judged against it. Where its equations are misprinted, what follows is shown in numbers."
        ),
        chapters=parts(
            runs,
            statements_section,
            source_section,
            kinematics_section,
            inertials_section,
            wrist_sensor_section,
            partial(_where_the_tool_is, calibrations),
            partial(gravity_section, calibrations),
            _admittance_control,
            plants_section,
        ),
        behind=(
            f"{len({run.hash for run in runs.values()})} runs and {len(calibrations)} calibrations lie behind this "
            "report, stored under outputs/runs and outputs/calibrations."
        ),
        runs=runs,
        expected=EXPECTED,
        checklist=load_checklist("meca500").section,
    )


def _where_the_tool_is(calibrations: Mapping[str, Calibration], _: Mapping[str, Run]) -> Section:
    return Section("Where the tool is", sections=parts(calibrations, tool_centre_point_section, tool_direction_section))


def _admittance_control(runs: Mapping[str, Run]) -> Section:
    return Section(
        "Admittance control",
        sections=parts(
            runs,
            step_response_section,
            frequency_response_section,
            at_the_tip_section,
            contact_section,
            stability_map_section,
            hand_guiding_section,
            limits_section,
        ),
    )
