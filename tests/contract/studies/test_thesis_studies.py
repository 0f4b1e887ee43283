"""Every study builds from short runs, and from runs of which some or all have failed."""

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from support.study_sections import every_run, texts, unfinished_texts, whatever_has_failed
from support.thin_plans import make_runs, stand_ins
from support.work_plans import chapter, thesis_moments

from runner import store
from runner.reporting import formulas
from runner.reporting.checklist import load_checklist
from runner.reporting.document import Document, Section, Table
from runner.reporting.figures import torque_and_error
from runner.reporting.job import MissingError
from runner.store import Run
from runner.works.thesis import measure

STUDIES = (
    *("questions", "coupling", "mass_ratio", "stage_sampling", "folding", "stretch", "reference_velocity", "bandwidth"),
    *("turns", "whole_body"),
)
SECTIONS = [chapter("thesis", f"{name}.md") for name in STUDIES]


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


@pytest.mark.parametrize("build", SECTIONS[1:], ids=lambda build: build.__name__)
def test_a_failed_run_is_shown_with_its_failure(
    runs: dict[str, Run], build: Callable[[Mapping[str, Run]], Section]
) -> None:
    assert any("for this test" in text for text in texts(build(every_run(runs))))


def test_the_dynamics_are_measured_once_and_read(
    runs: dict[str, Run], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / measure.FILE
    build = chapter("thesis", "dynamics_cost.md")
    folder = shutil.copytree(runs["mass/0.2/known"].folder, tmp_path / "runs" / "copied")
    copied = {"copied": store.open_run(folder), **runs}
    with pytest.raises(MissingError, match="not measured; runner reproduce thesis makes it"):
        build(copied)
    monkeypatch.setattr(measure, "_BLOCKS", 1)
    monkeypatch.setattr(measure, "_CALLS", 3)
    measure.measure(tmp_path)
    content = path.read_bytes()
    measure.measure(tmp_path)
    assert path.read_bytes() == content
    record = measure.load(path)
    assert record is not None
    assert [row["joints"] for row in record["rows"]] == list(range(3, 31, 3))
    section = build(copied)
    assert formulas.faulty(document([section])) == []
    path.write_text("{}")
    assert measure.load(path) is None


def test_the_checklist_finds_its_places_and_names_what_is_missing(runs: dict[str, Run]) -> None:
    figure = torque_and_error(runs["figure_5_8/sound"], "A figure.", "figure 5.8")
    checklist = load_checklist("thesis")
    assert checklist is not None
    section = checklist.section([Section("Elsewhere"), Section("Here", sections=(Section("Below", (figure,)),))])
    rows = {row[0]: row for block in section.blocks if isinstance(block, Table) for row in block.rows}
    assert len(rows) == 42
    assert rows["Figure 5.8"][2:] == ["reproduced", "§2.1"]
    assert rows["Figure 5.9"][2] == "missing"
    assert rows["Figure 1.1"][2].startswith("of others")


def test_stored_runs_are_enough(runs: dict[str, Run]) -> None:
    again = {name: store.open_run(run.folder) for name, run in runs.items()}
    folding = chapter("thesis", "folding.md")
    assert list(texts(folding(again))) == list(texts(folding(runs)))
