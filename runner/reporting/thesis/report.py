"""The whole thesis report, from its stored runs."""

from collections.abc import Mapping

from runner.reporting.document import Document, Section, Text
from runner.reporting.run_report import provenance
from runner.reporting.thesis.base_axis import base_axis_section, duration_section
from runner.reporting.thesis.chapter2 import chapter2
from runner.reporting.thesis.chapter3 import chapter3
from runner.reporting.thesis.chapter4 import chapter4
from runner.reporting.thesis.claims import claims_section
from runner.reporting.thesis.gravity_and_lag import gravity_section, lag_section
from runner.reporting.thesis.physics import plants_section, sampling_section, similarity_section
from runner.store import Run


def thesis_document(runs: Mapping[str, Run]) -> Document:
    """Return the report on chapters 2 to 4 of the thesis.

    Args:
        runs: The stored runs of `plan()`, by name.
    """
    return Document(
        title="Control of a Macro-Mini Robotic Manipulator",
        subtitle="Chapters 2 to 4 of the thesis (National University of Singapore, 2008), reproduced",
        abstract=(
            "Every figure, table and number of chapters 2 to 4 made again from simulation, with a verdict on each "
            "number. The printed "
            "numbers follow from controllers that left out the gravity term and the feedforward which the thesis' own "
            "equations contain: with them (preset sound) steady-state and tracking errors fall by one to three "
            "powers of ten."
        ),
        sections=(
            claims_section(runs),
            chapter2(runs),
            chapter3(runs),
            chapter4(runs),
            Section(
                "What explains the numbers",
                sections=(
                    gravity_section(runs),
                    lag_section(runs),
                    base_axis_section(runs),
                    duration_section(runs),
                ),
            ),
            Section(
                "Whether the simulation can be trusted",
                sections=(
                    plants_section(runs),
                    sampling_section(runs),
                    similarity_section(runs),
                ),
            ),
            Section(
                "Provenance",
                (
                    Text(
                        f"{len(runs)} runs lie behind this report, each stored with its config, trace and metrics "
                        "under "
                        "outputs/runs. Figures show repetition 0; numbers are medians over the repetitions."
                    ),
                    provenance(list(runs.values())),
                ),
            ),
        ),
        date=max(str(run.provenance["date"]) for run in runs.values()),
    )
