import re

import pytest

from runner.audit.audit import audit
from runner.audit.verdict import VERDICTS
from runner.reporting import formulas, html, outline
from runner.reporting.audit.report import audit_document
from runner.reporting.document import Curves, Equations, Table
from runner.reporting.templating import VERDICT_SIGNS


@pytest.fixture(scope="module")
def judged():
    return {source: audit(source, samples=50) for source in ("xarm7", "meca500")}


@pytest.fixture(scope="module")
def document(judged):
    return audit_document(judged)


@pytest.fixture(scope="module")
def page(document):
    return html.render(document)


def tables(document, kind):
    return [block for block in outline.blocks(document) if isinstance(block, kind)]


def test_each_source_has_one_table_with_a_row_for_each_equation(document, judged):
    found = tables(document, Equations)
    assert [len(table.rows) for table in found] == [len(each) for each in judged.values()]
    assert all(row.forms for table in found for row in table.rows)


def test_the_counts_add_up(document, judged):
    counts = tables(document, Table)[0]
    total = [int(cell) for cell in counts.rows[-1][1:]]
    assert sum(total[:-1]) == total[-1] == sum(map(len, judged.values()))
    assert counts.header[1:-1] == list(VERDICTS)


def test_each_place_has_as_many_equations_as_are_printed(document):
    places = tables(document, Table)[1]
    assert all(row[2] == row[3] for row in places.rows)


def test_every_formula_is_valid(document):
    assert formulas.faulty(document) == []


def test_each_wrong_formula_that_is_run_has_its_curves(document):
    assert len(tables(document, Curves)) == 11


def test_the_page_can_be_searched_by_what_is_printed(page, judged):
    rows = re.findall(r'<tr data-verdict="([^"]*)">(.*?)</tr>', page, re.DOTALL)
    assert len(rows) == sum(map(len, judged.values()))
    assert {verdict for verdict, _ in rows} <= set(VERDICTS)
    shown = [re.sub(r"\s+", "", re.sub(r"<[^>]*>", "", row)) for _, row in rows]
    assert sum("J_43AngularvelocityalongxA".removesuffix("A") in text for text in shown) == 1
    assert any("l4cos(q1)" in text for text in shown)
    assert any("l4cos(θ1)" in text for text in shown)
    assert page.count('type="search"') == 2


def test_every_verdict_has_a_sign():
    assert set(VERDICTS) <= set(VERDICT_SIGNS)
