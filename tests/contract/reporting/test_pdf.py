"""Documents as PDF by Typst: any string, the same bytes each time."""

from dataclasses import replace

import numpy as np
import pytest
from support.pdf_text import pages
from support.sample_document import HOSTILE, document

from runner.reporting import render
from runner.reporting.document import Curves, Document, Panel, ReportBlock, Section, Series, Table, Text
from runner.reporting.render import render_pdf
from runner.reporting.table import numbers
from runner.reporting.templating import quote_typst, typst_environment, typst_value


@pytest.mark.parametrize("kind", ReportBlock.__subclasses__(), ids=lambda kind: kind.block)
def test_every_block_type_has_a_macro(kind):
    blocks = typst_environment().get_template(f"{kind.templates}.typ.j2").make_module({})
    assert callable(getattr(blocks, kind.block))


@pytest.mark.parametrize("text", HOSTILE)
def test_any_text_in_any_field_gives_a_document(text):
    assert render_pdf(document(text)).startswith(b"%PDF")


@pytest.mark.parametrize("text", HOSTILE)
def test_a_template_inserts_texts_as_strings_only(text):
    inserted = typst_environment().from_string("#f(<< text >>)").render(text=text)
    assert inserted == f"#f({quote_typst(text)})"
    body = inserted[len('#f("') : -len('")')]
    assert '"' not in body.replace("\\\\", "").replace('\\"', "")
    assert "\n" not in body


def test_a_template_refuses_what_is_neither_text_nor_number():
    with pytest.raises(TypeError, match="not list"):
        typst_value([1])


def test_the_same_document_gives_the_same_bytes():
    assert render_pdf(document()) == render_pdf(document())


def test_the_date_is_that_of_the_document():
    assert b"20261121" in render_pdf(document())
    assert render_pdf(replace(document(), date="no date")).startswith(b"%PDF")


def test_long_tables_break_over_pages(monkeypatch):
    rows = [[f"{number}", "x" * 300] for number in range(120)]
    made = Document("T", "", "", [Section("S", [Table("Long.", [*numbers("n"), "word"], rows)])], "2026-11-21")
    compile_typst = render.typst.compile
    monkeypatch.setattr(
        render.typst, "compile", lambda *given, **named: compile_typst(*given, **named | {"format": "svg"})
    )
    assert len(render_pdf(made)) > 4


def test_a_link_leads_to_its_section_and_one_without_section_is_text():
    table = Table("where", ["place"], [["§1"], ["§9.9"]])
    links = render_pdf(Document("t", "s", "a", [Section("one", [table])], "2026-01-01"))
    plain = render_pdf(Document("t", "s", "a", [Section("one", [replace(table, rows=[["1"], ["9.9"]])])], "2026-01-01"))
    assert links.count(b"/Subtype/Link") == plain.count(b"/Subtype/Link") + 1


@pytest.mark.costs(2)
def test_figures_and_tables_stay_in_their_section_within_a_page_of_their_mention():
    series = [Series("a", np.arange(3.0), np.arange(3.0))]
    names = [f"N{number}" for number in range(9)]
    sections = [
        Section(
            f"Section {name}",
            (
                Text(f"Mention {name}. " + "Words. " * 90 * (number % 3)),
                Curves("Shown.", [Panel("", "x", "y", series)] * (1 + 2 * (number % 2)), 1, finding=f"Finding {name}."),
                Table(f"Listed {name}.", ["n"], [["1"]] * 4),
            ),
        )
        for number, name in enumerate(names)
    ]
    made = pages(render_pdf(Document("T", "", "", [Section("Chapter", sections=sections)], "")))
    text = " ".join(made)
    # The last place of a heading: the contents name it, too.
    order = [text.rindex(f"{word} {name}") for name in names for word in ("Section", "Mention", "Finding", "Listed")]
    assert order == sorted(order)
    page = {word: [next(at for at, each in enumerate(made) if f"{word} {name}" in each) for name in names]
            for word in ("Mention", "Finding")}  # fmt: skip
    assert max(np.subtract(page["Finding"], page["Mention"])) <= 1
    assert len(made) > 3
