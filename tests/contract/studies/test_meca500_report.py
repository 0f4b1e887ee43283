"""The Meca500 report as a document, from real runs of its thin plan: tables, verdicts, commands, HTML and PDF."""

import re

import pytest
from support.engines import DEFAULT_PLANT

from runner.reporting import outline
from runner.reporting.document import Curves, Notice, Playback, Table, Text
from runner.reporting.mathml import faulty
from runner.reporting.render import write_report

pytestmark = pytest.mark.bullet  # its study has walls and tools on the default plant


@pytest.fixture(scope="session")
def document(made):
    return made("meca500").document


def blocks_of(document, *kinds):
    return [block for block in outline.blocks(document) if isinstance(block, kinds)]


def table(document, caption):
    return next(block for block in blocks_of(document, Table) if block.caption.startswith(caption))


def test_the_checklist_finds_a_place_for_everything(document):
    rows = table(document, "Tables and formulas of the report").lines[1:]
    assert len(rows) == 12
    assert all(re.fullmatch(r"§\d+(\.\d+)?", where) and state != "missing" for *_, state, where in rows)


def test_the_lost_turns_of_table_1_are_needed(document):
    rows = {row[0]: row[1:] for row in table(document, "Frame 6 by the modified D-H table").lines[1:]}
    assert float(rows["as printed, without both"][0]) > 100.0
    assert rows["without 180° of joint 6"][2] == "180"
    assert set(rows["with both turns"]) <= {"0", "0 (rounding)"}


def test_every_element_of_transform_and_jacobians_has_a_verdict(document):
    transform = table(document, "Elements of the transform")
    assert [len(row) for row in transform.lines[1:]] == [5, 5, 5]
    frame_6 = {row[0]: row[1:] for row in table(document, "Elements of the Jacobian in frame 6").lines[1:]}
    assert frame_6["2"][0].startswith("wrong by up to 2")  # the root, at most 28.4 mm/rad
    assert frame_6["2"][1:] == ["right"] * 5
    assert all(cell.startswith("wrong") for cell in frame_6["3"][:5])


def test_the_two_sets_of_inertials_differ_by_a_third(document):
    rows = {row[0]: row for row in table(document, "The two sets of masses").lines[1:]}
    assert rows["link5"][1:] == ["0.488", "0.358", "1.36", "CAD"]


def test_the_plants_disagreement_is_measured_and_shrinks_with_the_step(document):
    rows = table(document, f"{DEFAULT_PLANT} by its step").lines[1:]
    coarse, middle, fine = (float(row[1].replace("·10⁻⁵", "e-5").replace("·10⁻⁶", "e-6")) for row in rows)
    assert middle / coarse == pytest.approx(0.5, rel=0.1)  # first order
    assert fine / middle == pytest.approx(0.5, rel=0.1)


def test_every_figure_has_its_command(document):
    figures = blocks_of(document, Curves, Playback)
    assert len(figures) >= 10
    assert all(re.match(r"runner (calibrate|experiment=meca500/)", figure.origin.command) for figure in figures)


def test_nothing_has_failed(document, made):
    runs = made("meca500").runs
    assert [name for name, stored in runs.items() if stored.status != "ok"] == []
    assert not [notice for notice in blocks_of(document, Notice) if notice.kind == "failure"]


def test_every_formula_can_be_set(document):
    assert faulty(document) == []


# Slow, as reports on a run, a sweep and a comparison are written with the same blocks.
@pytest.mark.slow
@pytest.mark.costs(3)
def test_html_and_pdf_are_written(document, tmp_path):
    html, pdf = write_report(document, tmp_path)
    assert not re.findall(r"(?:src|href)=[\"']?(?:https?:)?//", html.read_text())
    assert pdf.read_bytes().startswith(b"%PDF")


def test_runs_and_calibrations_are_counted_once_though_some_have_several_names(document, made_meca500):
    texts = [block.text for block in blocks_of(document, Text) if "calibrations lie behind this report" in block.text]
    assert re.findall(r"and (\d+) calibrations", texts[0]) == ["36"]
    runs = len({run.hash for run in made_meca500.runs.values()})
    assert runs < len(made_meca500.runs)
    assert texts[0].startswith(f"{runs} runs and")
    assert any(f"of {runs} runs carry some" in note for note in document.notes)
