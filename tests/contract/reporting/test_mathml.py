"""Formulas as MathML: marks, accents, pieces, faulty ones, and one compilation for all."""

import xml.etree.ElementTree as ET

import pytest
from support import sample_document

from runner.reporting import mathml
from runner.reporting.document import Document, Formula, Section, Text


def made(text, *, displayed=False):
    return mathml.mathml([text], displayed=displayed)[text]


def test_a_formula_is_mathematics_that_can_be_selected():
    assert "".join(ET.fromstring(made("x_1 + 2 y")).itertext()) == "𝑥1+2𝑦"
    assert made("x", displayed=True).startswith('<math display="block">')


def test_accents_are_spacing_ones():
    accents = {
        each.text: each.get("stretchy") for each in ET.fromstring(made("dot(x) hat(x) dot.double(x)")).iter("mo")
    }
    assert accents == {"\u02d9": "false", "\u02c6": "false", "\u00a8": "false"}


@pytest.mark.parametrize(("typst", "tag"), [("overline(x)", "mover"), ("underline(x)", "munder")])
def test_a_line_over_or_under_a_letter_stays(typst, tag):
    lined = ET.fromstring(made(typst)).find(tag)
    assert ["".join(part.itertext()) for part in lined] == ["𝑥", "¯"]


def test_brackets_grow_with_fractions_only():
    assert [each.get("stretchy") for each in ET.fromstring(made("M(q)")).iter("mo")] == ["false", "false"]
    assert [each.get("stretchy") for each in ET.fromstring(made("(a/b)")).iter("mo")] == [None, None]


def test_what_differs_is_a_marked_row_whose_sign_has_spaces():
    row = ET.fromstring(made("a differs(+ b)")).find("mrow")
    assert row.get("class") == "differs"
    assert row[0].get("form") == "infix"


def test_a_long_formula_in_a_line_breaks_before_its_signs_and_a_displayed_one_does_not():
    long = "y = " + " + ".join(f"a_{i} b_{i}" for i in range(9))
    pieces = ET.fromstring(f"<p>{made(long)}</p>")
    assert [each[0].text for each in pieces] == ["𝑦", "=", *8 * ["+"]]
    assert {each[0].get("form") for each in pieces} == {None, "infix"}
    assert len(ET.fromstring(f"<p>{made(long, displayed=True)}</p>")) == 1
    assert len(ET.fromstring(f"<p>{made('a = b + c')}</p>")) == 1


@pytest.mark.parametrize(
    "source",
    ["#read(\"/etc/passwd\")", "unknown_name", "a $ b", "sqrt(", 'std.read("/mathml.typ")', "std.sys.inputs", '"'],
)  # fmt: skip
def test_a_faulty_formula_is_refused_and_the_others_are_made(source):
    found = mathml.mathml(["alpha", source, "beta"], displayed=False)
    assert found[source] is None
    assert found["alpha"] is not None
    assert found["beta"] is not None


def test_faulty_names_what_a_report_would_show_as_source():
    document = Document("", "", "$omega$", [Section("", [Text("$nonsense_here$ $x$"), Formula("worse here")])], "")
    assert mathml.faulty(document) == ["worse here", "nonsense_here"]


def test_one_compilation_serves_all_formulas_and_is_kept(monkeypatch):
    texts = [f"kept_{i}".replace("kept", "k") for i in range(20)]
    calls = []
    compile_ = mathml.typst.compile
    monkeypatch.setattr(
        mathml.typst, "compile", lambda *given, **named: calls.append(given) or compile_(*given, **named)
    )
    mathml.mathml(texts, displayed=False)
    mathml.mathml(texts, displayed=False)
    assert len(calls) == 1


def test_a_document_without_mathematics_has_no_faulty_formula():
    assert mathml.faulty(Document("", "", "", sample_document.document().sections[0].sections, "")) == []
