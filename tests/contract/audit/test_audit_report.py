"""The report on the audit of two sources: tables, counts, marks and curves."""

import re
import unicodedata

import pytest

from runner.papers.audit.audit import audit
from runner.papers.audit.verdict import VERDICTS
from runner.papers.reporting.audit_report import audit_document
from runner.papers.reporting.equation import Equations
from runner.reporting import mathml, outline
from runner.reporting.document import Curves, Table
from runner.reporting.outline import tallies
from runner.reporting.render import render_html
from runner.reporting.verdicts import WORDS


@pytest.fixture(scope="module")
def checked():
    return {source: audit(source, samples=50) for source in ("xarm7", "meca500")}


@pytest.fixture(scope="module")
def document(checked):
    return audit_document(checked)


@pytest.fixture(scope="module")
def page(document):
    return render_html(document)


def tables(document, kind):
    return [block for block in outline.blocks(document) if isinstance(block, kind)]


@pytest.mark.costs(5)
def test_the_report_is_as_recorded(document, as_recorded):
    as_recorded("reports", "audit", document, [r"title: The line by joint rates, with the printed pseudo-inverse"])


@pytest.mark.costs(5)
def test_each_source_has_one_table_with_a_row_for_each_equation(document, checked):
    found = tables(document, Equations)
    assert [len(table.rows) for table in found] == [len(each) for each in checked.values()]
    assert all(row.forms for table in found for row in table.rows)


def test_the_counts_add_up(document, checked):
    counts = tables(document, Table)[0]
    total = [int(cell) for cell in counts.rows[-1][1:]]
    assert sum(total[:-1]) == total[-1] == sum(map(len, checked.values()))
    assert counts.lines[0][1:-1] == list(VERDICTS)


def test_each_place_has_as_many_equations_as_are_printed(document):
    places = tables(document, Table)[-1]
    assert all(row[2] == row[3] for row in places.rows)


def test_every_formula_is_valid(document):
    assert mathml.faulty(document) == []


def test_each_wrong_formula_that_is_run_has_its_curves(document):
    panels = [panel for figure in tables(document, Curves) for panel in figure.panels]
    assert len(panels) == len({panel.title for panel in panels}) == 11


def squeezed(text):
    """Return a string as the page's search compares it: see report.js."""
    return re.sub(r"[\s·*_]+", "", unicodedata.normalize("NFKC", re.sub(r"<[^>]*>", "", text)))


def shown(page):
    row = r'<div class="equation-row" data-verdict="([^"]*)">(.*?)(?=<div class="equation-row"|</details>\n)'
    return re.findall(row, page, re.DOTALL)


def test_the_page_can_be_searched_by_what_is_printed(page, checked):
    found = shown(page)
    assert len(found) == sum(map(len, checked.values()))
    assert {verdict for verdict, _ in found} <= set(VERDICTS)
    texts = [squeezed(row) for _, row in found]
    assert sum("J43Angularvelocityalongx" in text for text in texts) == 1
    assert any("l4cos(q1)" in text for text in texts)
    assert any("l4cos(θ1)" in text for text in texts)
    assert len(set(re.findall(r'role="search" aria-label="([^"]*)"', page))) == 2


def test_wrong_equations_come_first_and_right_ones_are_folded(page):
    order = [verdict for verdict, _ in shown(page)]
    first = order[: order.index("definition")]
    assert list(dict.fromkeys(first)) == ["wrong as printed", "unreadable", "correct after emendation", "correct"] or (
        list(dict.fromkeys(first)) == ["wrong as printed", "unreadable", "correct"]
    )
    assert page.count('<details class="verdict" open>') == 5
    assert page.count('<details class="verdict">') == 4


def test_what_differs_is_marked_in_both_forms(document):
    rows = {row.number: row for table in tables(document, Equations) for row in table.rows}
    printed, corrected = rows["P_ex"].forms
    marks = [set(re.findall(r'differs\(italic\("(.)"\)_"(\d)"\)', *form.lines[0])) for form in (printed, corrected)]
    assert marks == [{("q", "1"), ("q", "2"), ("q", "5")}, {("θ", "1"), ("θ", "2")}]


def test_an_emended_relation_is_mathematics_where_the_damaged_one_is(document):
    rows = {row.number: row for table in tables(document, Equations) for row in table.rows}
    printed, emended = rows["S2 P"].forms
    assert printed.lines
    assert emended.lines == [['""^(S_2) P_(S_1) = - ""_(S_1)^(S_2) R ""^(S_1) P_(S_2)']]


def test_a_shifted_column_is_named_and_not_printed_again(document):
    rows = {row.number: row for table in tables(document, Equations) for row in table.rows}
    assert 'the right $italic("J")_"12"$, with $italic("q")_"1"$' in rows["J_13"].forms[0].note
    assert rows["J_13"].forms[0].lines == ()


def test_squares_lead_to_the_equations_of_each_verdict(document, page):
    for tally in tallies(document):
        assert sum(int(square.number) for square in tally.squares) == sum(count for _, count in tally.counts)
        for square in tally.squares:
            assert page.count(f'id="{square.place}"') == 1
            assert f'href="#{square.place}"' in page


def test_the_page_leads_to_the_table_beside_it(page):
    assert page.count('href="equations.csv" download') == 2


def test_every_verdict_has_a_sign():
    assert set(VERDICTS) <= set(WORDS)
