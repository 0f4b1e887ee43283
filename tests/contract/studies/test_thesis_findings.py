"""Conclusions of the thesis' chapters, refuted by runs that contradict them."""

from collections.abc import Callable

import pytest
from fixtures.studies import Made
from support.study_sections import every_run

from runner.papers.studies.thesis import figures
from runner.papers.study.measured import findings
from runner.reporting.document import Document, Section
from runner.reporting.mathml import faulty


@pytest.mark.parametrize(("claim", "ends"), [(3, (0.1, 0.15)), (4, (0.007, 0.044))])
def test_the_printed_tracking_errors_are_not_those_at_rest(claim: int, ends: tuple[float, float]) -> None:
    assert tuple(figures.printed(claim, end, "").value for end in (0, -1)) == ends


@pytest.mark.parametrize("name", ["turns", "mass_ratio", "whole_body", "reference_velocity", "folding"])
def test_a_finding_on_failed_runs_alone_no_longer_holds(made: Callable[[str], Made], name: str) -> None:
    document = _document(made("thesis").spoiled(every_run).section(f"{name}.md"))
    assert [found.claim for _, found in findings(document) if found.holds] == []
    assert faulty(document) == []


def _document(section: Section) -> Document:
    return Document("", "", "", (section,), "2026-01-01")
