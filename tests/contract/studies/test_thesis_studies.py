"""Studies on the thesis: failed runs, and the checklist."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import pytest
from fixtures.studies import Made
from support.study_sections import every_run, texts

from runner.reporting.document import Origin, Section, Table
from runner.reporting.figures import torque_and_error
from runner.store import Run
from runner.study.report import load_checklist

STUDIES = ("coupling", "mass_ratio", "folding", "stretch", "reference_velocity", "turns", "whole_body")


@pytest.fixture
def runs(made: Callable[[str], Made]) -> Mapping[str, Run]:
    return made("thesis").runs


def test_a_failed_run_is_shown_with_its_failure(made: Callable[[str], Made]) -> None:
    chapters = made("thesis").spoiled(every_run)
    told = {name: any("for this test" in text for text in texts(chapters.section(f"{name}.md"))) for name in STUDIES}
    assert told == dict.fromkeys(STUDIES, True)


def test_the_checklist_finds_its_places_and_names_what_is_missing(runs: Mapping[str, Run]) -> None:
    figure = replace(torque_and_error(runs["figure_5_8/full_equations"], "A figure."), origin=Origin("figure 5.8"))
    checklist = load_checklist("thesis")
    assert checklist is not None
    section = checklist.section([Section("Elsewhere"), Section("Here", sections=(Section("Below", (figure,)),))])
    rows = {row[0]: row for block in section.blocks if isinstance(block, Table) for row in block.lines[1:]}
    assert len(rows) == 42
    assert rows["Figure 5.8"][2:] == ["reproduced", "§2.1"]
    assert rows["Figure 5.9"][2] == "missing"
    assert rows["Figure 1.1"][2].startswith("of others")
