"""Every study builds from short runs, and from runs of which some or all have failed."""

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from study_sections import every_run, texts, unfinished_texts, whatever_has_failed
from thin_plans import make_runs, stand_ins
from work_plans import thesis_moments

from runner import store
from runner.reporting import formulas
from runner.reporting.checklist import load_checklist
from runner.reporting.document import Document, Section, Table
from runner.reporting.figures import torque_and_error
from runner.store import Run
from runner.works.chapters import chapter
from runner.works.thesis import dynamics_benchmark, report
from runner.works.thesis.bandwidth import bandwidth_section
from runner.works.thesis.coupling import coupling_section
from runner.works.thesis.dynamics_cost import dynamics_cost_section
from runner.works.thesis.folding import folding_section
from runner.works.thesis.mass_ratio import mass_ratio_section
from runner.works.thesis.questions import questions_section
from runner.works.thesis.reference_velocity import reference_velocity_section
from runner.works.thesis.stage_sampling import stage_sampling_section
from runner.works.thesis.stretch import stretch_section
from runner.works.thesis.whole_body import whole_body_section

SECTIONS = (
    questions_section,
    coupling_section,
    mass_ratio_section,
    stage_sampling_section,
    folding_section,
    stretch_section,
    reference_velocity_section,
    bandwidth_section,
    chapter(report.__file__, "turns"),
    whole_body_section,
    dynamics_cost_section,
)


@pytest.fixture(scope="module")
def runs(shared_store: Path, thin: bool) -> dict[str, Run]:
    """Every run of the plan, cut to a moment."""
    return make_runs(shared_store, thesis_moments(), stand_ins(thesis_moments(), thin))


def document(sections: list[Section]) -> Document:
    return Document("Studies", "", "", sections, "2026-01-01")


@whatever_has_failed
def test_every_section_builds_whatever_has_failed(runs: dict[str, Run], spoil: Callable[..., dict[str, Run]]) -> None:
    sections = [build(spoil(runs)) for build in SECTIONS]
    assert formulas.faulty(document(sections)) == []
    for section in sections:
        assert section.blocks
        assert not unfinished_texts(section)


@pytest.mark.parametrize("build", [s for s in SECTIONS if s not in (questions_section, dynamics_cost_section)])
def test_a_failed_run_is_shown_with_its_failure(
    runs: dict[str, Run], build: Callable[[Mapping[str, Run]], Section]
) -> None:
    assert any("for this test" in text for text in texts(build(every_run(runs))))


def test_the_dynamics_are_measured_once_and_read(
    runs: dict[str, Run], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / dynamics_benchmark.FILE
    folder = shutil.copytree(runs["mass/0.2/known"].folder, tmp_path / "runs" / "copied")
    copied = {"mass/0.2/known": store.open_run(folder)}
    assert "Not measured" in list(texts(dynamics_cost_section(copied)))
    monkeypatch.setattr(dynamics_benchmark, "_BLOCKS", 1)
    monkeypatch.setattr(dynamics_benchmark, "_CALLS", 3)
    dynamics_benchmark.measure(path)
    content = path.read_bytes()
    dynamics_benchmark.measure(path)
    assert path.read_bytes() == content
    record = dynamics_benchmark.load(path)
    assert record is not None
    assert [row["joints"] for row in record["rows"]] == list(range(3, 31, 3))
    section = dynamics_cost_section(copied)
    assert formulas.faulty(document([section])) == []
    path.write_text("{}")
    assert dynamics_benchmark.load(path) is None


def test_the_checklist_finds_its_places_and_names_what_is_missing(runs: dict[str, Run]) -> None:
    figure = torque_and_error(runs["figure_5_8/sound"], "A figure.", "figure 5.8")
    section = load_checklist("thesis").section(
        [Section("Elsewhere"), Section("Here", sections=(Section("Below", (figure,)),))]
    )
    rows = {row[0]: row for block in section.blocks if isinstance(block, Table) for row in block.rows}
    assert len(rows) == 38
    assert rows["Figure 5.8"][2:] == ["reproduced", "§2.1"]
    assert rows["Figure 5.9"][2] == "missing"
    assert rows["Figure 1.1"][2].startswith("of others")


def test_stored_runs_are_enough(runs: dict[str, Run]) -> None:
    again = {name: store.open_run(run.folder) for name, run in runs.items()}
    assert folding_section(again).title == folding_section(runs).title
