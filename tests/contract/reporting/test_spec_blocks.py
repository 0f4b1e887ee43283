"""Blocks on the spec in reports on runs."""

import pytest

from runner.reporting import outline
from runner.reporting.comparison.runs import runs_document
from runner.reporting.document import Notice, Table
from runner.reporting.mathml import faulty
from runner.reporting.render import write_report
from runner.reporting.run_report import run_document
from runner.reporting.spec_blocks import COLUMNS, bound_text
from runner.schema.bound import Bound


@pytest.fixture(scope="module")
def made(runs):
    """Two runs with different specs, the second without the metric, and one run without a spec."""
    torque = Bound(max=1.0, reason="gear <b>2</b>")
    return [
        runs["rk4"].judged_by({"peak_torque": torque, "cross_track_error": Bound(max=1.0)}, {}),
        runs["goal"].judged_by({"max_tracking_error": Bound(max=1.0)}, {}),
        runs["noise"],
    ]


def specs(document):
    found = [block for block in outline.blocks(document) if isinstance(block, Table)]
    return [block for block in found if "Clopper and Pearson" in block.caption]


def test_the_report_on_a_run_has_its_bounds_with_reasons(made, tmp_path):
    document = run_document(made[0])
    (table,) = specs(document)
    assert table.header == [*COLUMNS, "reason"]
    assert [row[1] for row in table.rows] == ["0 of 40", "40 of 40", "0 of 40"]
    assert table.rows[0][2:4] == ["1", "0.912 to 1"]
    assert "0 of 40 repetitions keep all 2 bounds of the spec: the probability of failing is 1" in document.abstract
    assert not faulty(document)
    html = write_report(document, tmp_path, ["html"])[0].read_text()
    assert "gear <b>2</b>" not in html
    assert "gear &lt;b&gt;2&lt;/b&gt;" in html


def test_a_metric_that_the_run_lacks_is_a_notice(made):
    document = run_document(made[1])
    titles = [block.title for block in outline.blocks(document) if isinstance(block, Notice)]
    assert "The run lacks a metric of its spec" in titles
    assert "The run lacks a metric of its spec." in document.abstract


def test_a_run_without_a_spec_has_nothing_of_it(made):
    document = run_document(made[2])
    assert not specs(document)
    assert "spec" not in document.abstract


def test_the_report_on_several_runs_has_one_table_of_all_bounds(made):
    document = runs_document(made)
    overall, *own = specs(document)
    assert [row[0] for row in overall.rows] == ["A", "A", "A", "B"]
    assert len(own) == 2
    differing = next(block for block in outline.blocks(document) if "differ" in getattr(block, "caption", ""))
    assert not any(row[0].startswith("spec") for row in differing.rows)  # a spec is not a difference between runs


@pytest.mark.parametrize(
    ("bound", "text"),
    [
        ({"max": 8e-4}, "steady-state error at most 0.8 mm"),
        ({"min": 0.25}, "steady-state error at least 0.25 m"),
        ({"min": 0.001, "max": 0.002}, "steady-state error 1 to 2 mm"),
    ],
)
def test_a_bound_in_words(bound, text):
    assert bound_text("steady_state_error", Bound(**bound)) == text
