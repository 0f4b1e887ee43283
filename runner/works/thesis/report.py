"""The whole thesis report, from its stored runs."""

from collections.abc import Mapping

from runner.reporting.checklist import load_checklist
from runner.reporting.document import Document, Section
from runner.reporting.work_report import parts, work_document
from runner.store import Calibration, Run
from runner.works.chapters import chapter
from runner.works.thesis.bandwidth import bandwidth_section
from runner.works.thesis.base_axis import base_axis_section, duration_section
from runner.works.thesis.caveats import EXPECTED
from runner.works.thesis.chapter2 import chapter2
from runner.works.thesis.chapter5 import chapter5
from runner.works.thesis.claims import claims_section
from runner.works.thesis.coupling import coupling_section
from runner.works.thesis.dynamics_cost import dynamics_cost_section
from runner.works.thesis.folding import folding_section
from runner.works.thesis.gravity_and_lag import gravity_section, lag_section
from runner.works.thesis.mass_ratio import mass_ratio_section
from runner.works.thesis.physics import plants_section, sampling_section, similarity_section
from runner.works.thesis.questions import questions_section
from runner.works.thesis.reference_velocity import reference_velocity_section
from runner.works.thesis.stage_sampling import stage_sampling_section
from runner.works.thesis.stretch import stretch_section
from runner.works.thesis.whole_body import whole_body_section


def document(runs: Mapping[str, Run], calibrations: Mapping[str, Calibration]) -> Document:
    """Return the report on the thesis.

    Args:
        runs: The stored runs of `plan()`, by name.
        calibrations: None: the work has none.
    """
    return work_document(
        title="Control of a Macro-Mini Robotic Manipulator",
        subtitle="The thesis (National University of Singapore, 2008), reproduced",
        abstract=(
            "Every figure, table and number of chapters 2 to 5 made again from simulation, with a verdict on each "
            "number, and answers to the questions that the thesis asks. Each is simulated twice: as reported, by a "
            "preset fitted to the printed numbers, and with the full equations of the thesis. What each conclusion "
            "needs to be true is checked when the report is made."
        ),
        chapters=parts(
            runs,
            claims_section,
            questions_section,
            chapter2,
            chapter(__file__, "chapter3"),
            chapter(__file__, "chapter4"),
            chapter5,
            _explanations,
            _beyond,
            _trust,
        ),
        behind=(
            f"{len({run.hash for run in runs.values()})} runs lie behind this report, each stored with its config, "
            "trace and metrics under outputs/runs. Figures show repetition 0; numbers are medians over the repetitions."
        ),
        runs=runs,
        expected=EXPECTED,
        checklist=load_checklist("thesis").section,
    )


def _explanations(runs: Mapping[str, Run]) -> Section:
    made = parts(runs, gravity_section, lag_section, base_axis_section, duration_section)
    return Section("What explains the numbers", sections=made)


def _beyond(runs: Mapping[str, Run]) -> Section:
    return Section(
        "What the thesis could not show",
        sections=parts(
            runs,
            coupling_section,
            mass_ratio_section,
            stage_sampling_section,
            folding_section,
            stretch_section,
            reference_velocity_section,
            bandwidth_section,
            chapter(__file__, "turns"),
            whole_body_section,
            dynamics_cost_section,
        ),
    )


def _trust(runs: Mapping[str, Run]) -> Section:
    made = parts(runs, plants_section, sampling_section, similarity_section)
    return Section("Whether the simulation can be trusted", sections=made)
