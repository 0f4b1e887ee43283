"""Formulas as images: their measures, faulty ones, and one compilation for all."""

import pytest
from support.sample_document import document

from runner.reporting import formulas
from runner.reporting.document import Document, Formula, Section, Text


def test_depth_is_how_far_a_formula_reaches_below_the_line():
    flat, deep = formulas.draw(["x", "x / y_(q_1)"], displayed=False).values()
    assert abs(flat.depth) < 0.05
    assert deep.depth > 0.3
    assert deep.depth < deep.height


def test_drawings_have_no_background():
    image = formulas.draw(["x^2"], displayed=True)["x^2"]
    assert "#ffffff" not in image.svg
    assert image.width > 0.5


@pytest.mark.parametrize(
    "source",
    ["#read(\"/etc/passwd\")", "unknown_name", "a $ b", "sqrt(", 'std.read("/formulas.typ")', "std.sys.inputs", '"'],
)  # fmt: skip
def test_a_faulty_formula_is_refused_and_the_others_are_drawn(source):
    images = formulas.draw(["alpha", source, "beta"], displayed=False)
    assert images[source] is None
    assert images["alpha"] is not None
    assert images["beta"] is not None


def test_faulty_names_what_a_report_would_show_as_source():
    made = Document("", "", "$omega$", [Section("", [Text("$nonsense_here$ $x$"), Formula("worse here", "")])], "")
    assert formulas.faulty(made) == ["worse here", "nonsense_here"]


def test_one_compilation_serves_all_formulas_and_is_kept(monkeypatch):
    texts = [f"kept_{i}".replace("kept", "k") for i in range(20)]
    calls = []
    make = formulas.typst.Compiler
    monkeypatch.setattr(
        formulas.typst, "Compiler", lambda *given, **named: calls.append(given) or make(*given, **named)
    )
    formulas.draw(texts, displayed=False)
    formulas.draw(texts, displayed=False)
    assert len(calls) == 1


def test_a_document_without_mathematics_has_no_faulty_formula():
    assert formulas.faulty(Document("", "", "", document().sections[0].sections, "")) == []
