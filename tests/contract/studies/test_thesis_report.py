"""The thesis report as a document: its published figures and tables, verdicts, first screen and formulas."""

import re
from collections import Counter

import pytest

from runner.papers.reporting.claims import Verdicts
from runner.reporting import outline
from runner.reporting.document import Curves, Picture, Table
from runner.reporting.mathml import faulty
from runner.reporting.outline import Places, tallies
from runner.reporting.render import write_report
from runner.reporting.words import PRESET

ONCE = (
    *("2.3", "2.4", "3.1", "3.4", "3.6", "3.7", "3.8", "4.1", "4.3"),
    *("5.1", "5.2", "5.3", "5.4", "5.5", "5.6", "5.7", "5.9", "5.11"),
)
FOR_BOTH_PRESETS = ("3.5", "3.9", "3.10", "4.2", "4.4", "5.8", "5.10", "5.12", "5.13")
TABLES = ("2.1", "3.1", "4.1", "5.1")


@pytest.fixture(scope="session")
def document(made):
    return made("thesis").document


def blocks_of(document, *kinds):
    return [block for block in outline.blocks(document) if isinstance(block, kinds)]


def test_every_figure_and_table_of_chapters_2_to_5_is_there(document):
    numbers = Counter(block.origin.number for block in blocks_of(document, Curves, Picture, Table))
    del numbers[""]  # our own
    expected = {f"figure {number}": 1 for number in ONCE}
    expected |= {f"figure {number}": 1 for number in FOR_BOTH_PRESETS}
    expected |= {f"table {number}": 1 for number in TABLES}
    assert numbers == expected


def test_every_published_figure_carries_its_command(document):
    for block in blocks_of(document, Curves, Picture, Table):
        if block.origin.number:
            assert re.match(r"runner (.* )?experiment=thesis/", block.origin.command)


def test_every_number_has_a_finding_for_each_preset(document):
    (claims,) = blocks_of(document, Verdicts)
    assert [claim.number for claim in claims.rows] == [str(number) for number in range(1, 18)]
    for claim in claims.rows:
        assert tuple(finding.preset for finding in claim.findings) == (*PRESET,)
        assert claim.reason


def test_the_minis_settling_time_contradicts_the_macros(document):
    (claims,) = blocks_of(document, Verdicts)
    claim = next(claim for claim in claims.rows if claim.number == "5")
    assert [finding.verdict for finding in claim.findings] == ["source contradicts itself", "source contradicts itself"]


def test_every_claim_leads_to_a_figure_that_the_report_shows(document):
    (claims,) = blocks_of(document, Verdicts)
    places = Places(document)
    assert {places.evidence(claim.command) in places.names for claim in claims.rows} == {True}


def test_the_first_screen_shows_the_arm_and_counts_the_verdicts(document):
    assert document.cover is not None
    assert "<animate" in document.cover.moving
    assert [tally.way for tally in tallies(document)] == list(PRESET.values())
    assert [len(tally.squares) for tally in tallies(document)] == [17, 17]
    assert document.notes[0].startswith("A printed number matches when ")


def test_the_report_opens_with_its_answers(document):
    assert len(document.answers) == 5
    assert document.sections[0].title == "Was the thesis right?"


def test_a_compared_figure_has_a_finding_and_at_most_six_panels_with_both_presets(document):
    figures = [
        block
        for block in blocks_of(document, Curves)
        if block.origin.number.removeprefix("figure ") in FOR_BOTH_PRESETS
    ]
    for figure in figures:
        assert 0 < len(figure.finding.split()) <= 12
        assert figure.caption.startswith("Torque")
        assert len(figure.panels) <= 6
        for panel in figure.panels:
            assert {series.name for series in panel.series} - {""} == {*PRESET.values()}
        printed = [panel.title for panel in figure.panels if "dotted: " in panel.title]
        assert printed


def test_every_formula_can_be_set(document):
    assert faulty(document) == []


@pytest.mark.slow  # the Meca500 report is written each time; only test_every_formula_can_be_set may fail here
def test_html_and_pdf_are_written(document, tmp_path):
    html, pdf = write_report(document, tmp_path)
    page = html.read_text()
    for number in (*ONCE, *FOR_BOTH_PRESETS):
        assert f"figure {number}" in page.lower()
    assert not re.findall(r"(?:src|href)=[\"']?(?:https?:)?//", page)
    assert pdf.read_bytes().startswith(b"%PDF")
