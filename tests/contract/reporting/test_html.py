"""Documents as HTML: no markup from strings, no network, the same page each time."""

import base64
import gzip
import hashlib
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from support.sample_document import HOSTILE, curves, document, playback

from runner.base.sanitize import plain
from runner.papers.reporting.claims import Claim, ClaimResult, Verdicts
from runner.reporting import outline
from runner.reporting.document import Code, Document, Origin, ReportBlock, Section, Text
from runner.reporting.markup import spans
from runner.reporting.render import render_html
from runner.reporting.templating import html_environment, typst_environment


class Page(HTMLParser):
    """Tags, attributes and shown text of a page, as a browser reads them."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.shown, self.scripts, self._open = [], [], "", [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += attributes
        self._open.append(tag)
        if tag == "script":
            self.scripts.append([dict(attributes), ""])

    def handle_endtag(self, tag):
        if self._open and self._open[-1] == tag:
            self._open.pop()

    def handle_data(self, data):
        if self._open and self._open[-1] == "script":
            self.scripts[-1][1] += data
        elif not (self._open and self._open[-1] == "style"):
            self.shown += data


@pytest.fixture(scope="module")
def quiet():
    return Page(render_html(document("words")))


@pytest.mark.parametrize("kind", ReportBlock.__subclasses__(), ids=lambda kind: kind.block)
def test_every_block_type_has_a_macro(kind):
    blocks = html_environment().get_template(f"{kind.templates}.html.j2").make_module({})
    assert callable(getattr(blocks, kind.block))


@pytest.mark.parametrize("text", HOSTILE)
def test_texts_add_no_tag_and_are_shown_literally(quiet, text):
    page = Page(render_html(document(text)).encode("utf-8", "replace").decode())
    # mathematics, or its source where it is refused
    extra = {"code", "br", "math", "mi", "mn", "mo", "mrow", "msub", "msup", "mtext", "mspace", "mfrac"}
    extra |= {"p"} if "\n" in text else set()  # a line of the abstract is a paragraph
    assert [tag for tag in page.tags if tag not in extra] == [tag for tag in quiet.tags if tag not in extra]
    assert not any(name.startswith("on") for name, _ in page.attributes)
    if not any(span.math for span in spans(text)):
        literal = " ".join(plain(text).replace("$$", "$").split())
        assert literal in " ".join(page.shown.split())


def sources(page):
    """Return the sources of scripts that the page's policy allows."""
    policies = [value for name, value in page.attributes if name == "content" and value.startswith("default-src")]
    (scripts,) = re.findall(r"script-src ([^;]*);", *policies)
    return scripts.split()


def sha256(text):
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"


@pytest.mark.parametrize("moving", [False, True])
def test_the_policy_lists_the_page_s_own_scripts_and_no_others(moving):
    blocks = [curves(), playback()] if moving else [curves()]
    page = Page(render_html(replace(document("words"), cover=None, sections=[Section("One", blocks)])))
    allowed = sources(page)
    scripts = [content for attributes, content in page.scripts if attributes.get("type") in (None, "module")]
    (library,) = [content for attributes, content in page.scripts if attributes.get("id") == "plotly"]
    scripts.append(gzip.decompress(base64.b64decode(library)).decode())
    assert allowed == [*map(sha256, scripts)]
    assert not any(value.startswith("javascript:") or name.startswith("on") for name, value in page.attributes if value)


def test_no_text_can_end_a_script():
    page = Page(render_html(document("</script><!--\u2028")))
    data = [content for attributes, content in page.scripts if attributes.get("type") == "application/json"]
    assert len(data) == 2  # runs, palette
    for content in data:
        json.loads(content)
        assert "\u2028" not in content


def test_nothing_is_asked_from_the_network():
    text = render_html(document())
    assert not re.findall(r"(?<!<a )(?:src|href)=[\"']?(?:https?:)?//", text)  # a link waits for a click
    assert "default-src 'none'" in text


def test_plotly_stands_once_and_only_where_curves_are():
    with_two = Document("", "", "", [Section("", [curves(), curves()])], "")
    without = Document("", "", "", [Section("", [Text("no curves")])], "")
    assert render_html(with_two).count('id="plotly"') == 1
    assert 'id="plotly"' not in render_html(without)
    packed = Page(render_html(with_two))
    (library,) = [content for attributes, content in packed.scripts if attributes.get("id") == "plotly"]
    assert b"Plotly" in gzip.decompress(base64.b64decode(library))


def test_a_motion_has_controls_and_several_runs_a_choice():
    tip = np.zeros((60, 3))
    several = playback(name="A", tip=tip, target=tip, others=[playback(30, name="B"), playback(30, name="C")])
    page = Page(render_html(Document("", "", "", [Section("", [playback(), several])], "")))
    names = [value for name, value in page.attributes if name == "name"]
    assert [name for name in names if name in ("speed", "error", "run", "ghost")] == [
        "speed", "speed", "error", "run", "ghost",
    ]  # fmt: skip
    assert page.tags.count("canvas") == 2
    assert not any("plotly" in str(value) for name, value in page.attributes if name == "id")


def test_a_page_without_figures_has_no_script_for_them():
    assert "startMotions" not in render_html(Document("", "", "", [Section("", [Text("words")])], ""))


def test_a_named_file_can_be_saved_and_is_not_on_paper():
    file = Document("", "", "", [Section("", [Code("a: <1>", "config.yaml")])], "")
    page = Page(render_html(file))
    assert [value for name, value in page.attributes if name == "data-save"] == ["config.yaml"]
    assert "a: <1>" in page.shown
    macros = typst_environment().get_template("blocks.typ.j2").make_module({})
    assert "a: <1>" not in macros.code(file.sections[0].blocks[0])
    assert "a: <1>" in macros.code(Code("a: <1>"))


def test_formulas_are_mathematics_and_the_page_has_their_font():
    page = render_html(Document("", "", "$omega_n$", [], ""))
    assert "<math><msub><mi>𝜔</mi><mi>𝑛</mi></msub></math>" in page
    assert page.count("data:font/woff2;base64,") == 1
    assert "data:font" not in render_html(Document("", "", "no mathematics", [], ""))


def test_data_and_pictures_are_packed_and_named_by_their_places():
    page = Page(render_html(document()))
    for kind, count in (("plots", 3), ("pictures", 2)):
        text = next(content for attributes, content in page.scripts if attributes.get("id") == kind)
        assert len(json.loads(gzip.decompress(base64.b64decode(text)))) == count
        attribute = {"plots": "data-plots", "pictures": "data-picture"}[kind]
        assert [value for name, value in page.attributes if name == attribute] == ["0", "1"]


def test_claims_figures_and_tables_are_places_that_texts_lead_to():
    origin = Origin("figure 3.5", "runner experiment=a/b")
    claim = Claim("3", "It settles", "page 1", "1 s", [ClaimResult("", "1 s", "matches")], "", "runner experiment=a/b")
    told = Text("claim 3 is judged by figure 3.5; figure 9.9 is not here")
    blocks = [told, Verdicts("All.", [claim]), curves("seen", origin=origin)]
    page = render_html(Document("", "", "", [Section("A", blocks)], ""))
    assert 'href="#claim-3">claim 3</a>' in page
    assert 'href="#figure-3-5">figure 3.5</a>' in page
    assert 'href="#figure-9-9"' not in page
    assert '<tr id="claim-3">' in page
    assert 'id="figure-3-5"' in page
    assert 'href="#figure-3-5" aria-label="Claim 3: to the evidence"' in page


@pytest.mark.parametrize("printed", ["1 s", ""])
def test_claims_of_a_source_without_values_have_no_column_of_printed_values(printed):
    found = [ClaimResult("", "1 s", "matches")]
    claims = [Claim("1", "It holds", "", "", found, ""), Claim("2", "It rests", "", printed, found, "")]
    told = Document("", "", "", [Section("A", [Verdicts("All.", claims)])], "")
    assert ('<th scope="col">printed</th>' in render_html(told)) == bool(printed)
    assert render_html(told).count("<th scope") == 3 + bool(printed) + 2


def test_the_same_document_gives_the_same_page():
    assert render_html(document()) == render_html(document())


def test_sections_are_numbered_and_listed():
    page = Page(render_html(replace(document(), sections=[Section("A", [], [Section("B")]), Section("C")])))
    own = ["#s1", "#s1-1", "#s2"]  # in the contents, and at the headings
    assert [value for name, value in page.attributes if name == "href" and value.startswith("#s")] == [*own, *own]


def test_every_figure_has_an_address_and_what_can_be_done_with_it():
    page = Page(render_html(document()))
    ids = [value for name, value in page.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    captioned = page.tags.count("figcaption")
    assert sum("figure" in name or "table" in name for name in ids) == captioned
    done = [value for name, value in page.attributes if name == "data-do"]
    drawn = [block.block for block in outline.blocks(document())]
    assert done.count("svg") == sum(drawn.count(kind) for kind in ("chart", "picture", "playback"))
    assert done.count("csv") == sum(drawn.count(kind) for kind in ("chart", "table", "verdicts", "playback"))
