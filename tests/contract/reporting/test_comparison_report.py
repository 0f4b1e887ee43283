"""The report on compared sweeps: first screen, tables, figure, and markup in configs."""

from dataclasses import replace

import numpy as np
import pytest
from support.sample_sides import LAWS, side

from runner.reporting.comparison.report import comparison_document
from runner.reporting.comparison.runs import runs_document
from runner.reporting.document import Code, Curves, Notice, Provenance, Table, Text
from runner.reporting.render import write_report


def error(robot, gravity):
    return {"macro": 0.01, "xarm7": 0.1}[robot] + gravity


def shifted(robot, gravity):
    return error(robot, gravity) + 0.25


def parts(sections, kind):
    """Return the blocks of a kind, in order."""
    return [
        block
        for section in sections
        for block in [*(one for one in section.blocks if isinstance(one, kind)), *parts(section.sections, kind)]
    ]


def pair(**of_b):
    return [side("A", LAWS, error, noise={"position": 1e-3}), side("B", LAWS, shifted, **of_b)]


@pytest.fixture(name="document")
def _document():
    return comparison_document(pair(noise={"position": 1e-4}))


def test_the_report_is_as_recorded(document, as_recorded):
    as_recorded("reports", "compared", document)


def test_the_first_screen_says_what_differs_how_many_cells_match_and_by_how_much(document):
    assert document.title == "Which noise.position: 0.001 (A) or 0.0001 (B)?"
    assert "\nA and B differ only in noise.position: 0.001 against 0.0001.\n" in document.abstract
    assert [[cell.text for cell in cells] for _, cells in document.map.rows] == [["A -2.5 %"] * 2] * 2
    assert "draw only noise" in document.abstract
    cells, differ, first = document.key_numbers
    assert cells[:2] == ("cells in both", "4")
    assert differ[1:] == ("1 value", "noise.position")
    assert first[:2] == ("rms tracking error, B - A", "0.25 m")
    assert "8 pairs: larger" in first[2]
    assert document.abstract.startswith("Rms tracking error: 2.5 % smaller with A than with B (10.01 m): by 0.25 m in")


def test_below_the_title_is_what_the_sweeps_share(document):
    assert document.subtitle == "A: A, B: B"  # they share no typed value
    axes = {**LAWS, "trajectory": ["quintic"]}
    sides = [side(name, axes, lambda *cell: error(*cell[:2])) for name in "AB"]
    assert comparison_document(sides).subtitle == "trajectory=quintic"


def test_a_confounded_comparison_is_marked_before_any_number(document):
    assert parts(document.sections, Notice) == []
    sides = pair(noise={"position": 1e-4}, plant={"step": 1e-3})
    (notice,) = parts(comparison_document(sides).sections, Notice)
    assert (notice.kind, notice.title) == ("warning", "More than one thing differs")
    assert "plant.step" in notice.text


def test_the_differing_values_stand_in_a_table_with_units(document):
    table = next(block for block in parts(document.sections, Table) if "resolved values" in block.caption)
    assert [list(row) for row in table.rows] == [["noise.position (rad)", "0.001", "0.0001", "all cells"]]


def test_every_metric_stands_in_a_table_and_parts_of_it_folded(document):
    whole, parts_ = (block for block in parts(document.sections, Table) if "cells below, above 0" in block.lines[0])
    assert [row[0] for row in whole.rows] == ["rms tracking error"]
    assert whole.rows[0][-2:] == ["larger", "0, 4"]
    assert parts_.folded
    assert [row[0] for row in parts_.rows] == ["largest torque, joint 1"]
    text = next(block.text for block in parts(document.sections, Text) if "signed-rank" in block.text)
    assert "corrected for all comparisons of a metric" in text


def test_each_cell_stands_in_the_figure_with_its_interval(document):
    (figure,) = parts(document.sections, Curves)
    (panel,) = figure.panels
    zero, dots, points = panel.series
    assert dots.y == pytest.approx([0.25] * 32)
    assert dots.x.tolist() == np.repeat(np.arange(4.0), 8).tolist()
    assert np.abs(dots.shift).max() == pytest.approx(0.3)
    assert points.y == pytest.approx([0.25] * 4)
    assert np.nanmax(zero.y) == 0.0
    assert (points.low <= points.y).all()
    assert (points.y <= points.high).all()
    assert panel.y_label == "difference in rms tracking error (m)"
    assert list(panel.x_names) == ["1", "2", "3", "4"]
    cells = next(block for block in parts(document.sections, Table) if block.caption == "The cells of the figure.")
    assert list(cells.rows[3]) == ["4", "xarm7", "9.81"]


def test_short_names_stand_below_the_figure():
    axes = {"robot": ["macro", "xarm7"]}
    one, other = side("A", axes, lambda _: 1.0), side("B", axes, lambda _: 1.1)
    (figure,) = parts(comparison_document([one, other]).sections, Curves)
    assert list(figure.panels[0].x_names) == ["macro", "xarm7"]


def test_of_many_cells_the_medians_are_drawn_against_each_other():
    axes = {"gravity": [9.0 + number / 100 for number in range(30)]}
    one, other = side("A", axes, lambda gravity: gravity), side("B", axes, lambda gravity: gravity + 1.0)
    (figure,) = parts(comparison_document([one, other]).sections, Curves)
    _, points = figure.panels[0].series
    assert points.y - points.x == pytest.approx(np.ones(30))
    assert figure.panels[0].x_label == "A (m)"


def test_more_than_two_sweeps_are_held_against_the_first():
    third = side("C", LAWS, error, noise={"position": 1e-2})
    document = comparison_document([*pair(noise={"position": 1e-4}), third])
    titles = [section.title for section in document.sections]
    assert titles == ["B against A", "C against A", "The sweeps", "Caveats", "Provenance"]


def test_caveats_of_both_and_the_commands_are_shown():
    one, other = pair()
    caveat = {"rule": "exact_velocity", "text": "velocities are exact", "value": 1.0}
    document = comparison_document([one, replace(other, caveats=[[caveat], [], [], [caveat]])])
    table = next(block for block in parts(document.sections, Table) if "caveat" in block.lines[0])
    assert [list(row) for row in table.rows] == [["B", "exact_velocity", "2 of 4", "velocities are exact"]]
    assert [block.text for block in parts(document.sections, Code)] == ["runner -m A", "runner -m B"]


def test_a_comparison_escapes_what_comes_from_a_config(tmp_path):
    one = side("A", {"robot": ["a<b>$x$", "b"]}, lambda _: 1.0, note={"text": "<script>1</script>"})
    other = side("B", {"robot": ["a<b>$x$", "b"]}, lambda _: 1.1)
    html, pdf = write_report(comparison_document([one, other]), tmp_path)
    assert "<script>1" not in html.read_text()
    assert pdf.stat().st_size > 0


def test_what_is_the_same_in_both_is_one_row_of_the_provenance():
    one, other = (replace(each, provenance={**each.provenance, "seed": ["1"]}) for each in pair())
    other = replace(other, provenance={**other.provenance, "commit": ["b"]})
    one = replace(one, provenance={**one.provenance, "commit": ["a"]})
    (found,) = parts(comparison_document([one, other]).sections, Provenance)
    assert ("seed", "1") in found.rows
    assert {("commit, A", "a"), ("commit, B", "b")} <= set(found.rows)
    assert not {"seed, A", "commit"} & {name for name, _ in found.rows}


def test_a_section_of_a_plug_in_is_before_the_details(own_section, runs):
    own_section("comparison", "' and '.join(side.name for side in subject.sides)")
    titles = [section.title for section in comparison_document(pair()).sections]
    assert titles[3:6] == ["Every metric", "Own", "The sweeps"]
    first, own, *_ = runs_document([runs["goal"], runs["other seed"]]).sections
    assert (first.title, own.blocks) == ("Side by side", (Text("A and B"),))
