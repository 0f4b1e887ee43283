"""Studies on the thesis: failed runs, the measured cost of the dynamics, and the checklist."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from fixtures.studies import Made
from support.study_sections import every_run, texts

from runner.reporting import formulas
from runner.reporting.document import Document, Section, Table
from runner.reporting.figures import torque_and_error
from runner.store import Run
from runner.studies.thesis import measure
from runner.study.job import MissingError
from runner.study.report import load_checklist
from runner.study.study import load_study

STUDIES = ("coupling", "mass_ratio", "stage_sampling", "folding", "stretch", "reference_velocity", "bandwidth", "turns",
           "whole_body")  # fmt: skip


@pytest.fixture
def runs(made: Callable[[str], Made]) -> Mapping[str, Run]:
    return made("thesis").runs


def test_a_failed_run_is_shown_with_its_failure(made: Callable[[str], Made]) -> None:
    chapters = made("thesis").spoiled(every_run)
    told = {name: any("for this test" in text for text in texts(chapters.section(f"{name}.md"))) for name in STUDIES}
    assert told == dict.fromkeys(STUDIES, True)


def test_the_dynamics_are_measured_once_and_read(
    runs: Mapping[str, Run], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / measure.FILE
    elsewhere = {name: replace(run, folder=tmp_path / "runs" / run.hash) for name, run in runs.items()}
    thesis = load_study("thesis")
    with pytest.raises(MissingError, match="not measured; runner reproduce thesis makes it"):
        thesis.chapters(elsewhere, {}).section("dynamics_cost.md")
    monkeypatch.setattr(measure, "_BLOCKS", 1)
    monkeypatch.setattr(measure, "_CALLS", 3)
    measure.measure(tmp_path)
    content = path.read_bytes()
    measure.measure(tmp_path)
    assert path.read_bytes() == content
    record = measure.load(path)
    assert record is not None
    assert [row["joints"] for row in record["rows"]] == list(range(3, 31, 3))
    section = thesis.chapters(elsewhere, {}).section("dynamics_cost.md")
    assert formulas.faulty(Document("Studies", "", "", [section], "2026-01-01")) == []
    path.write_text("{}")
    assert measure.load(path) is None


def test_the_checklist_finds_its_places_and_names_what_is_missing(runs: Mapping[str, Run]) -> None:
    figure = torque_and_error(runs["figure_5_8/full_equations"], "A figure.", "figure 5.8")
    checklist = load_checklist("thesis")
    assert checklist is not None
    section = checklist.section([Section("Elsewhere"), Section("Here", sections=(Section("Below", (figure,)),))])
    rows = {row[0]: row for block in section.blocks if isinstance(block, Table) for row in block.rows}
    assert len(rows) == 42
    assert rows["Figure 5.8"][2:] == ["reproduced", "§2.1"]
    assert rows["Figure 5.9"][2] == "missing"
    assert rows["Figure 1.1"][2].startswith("of others")
