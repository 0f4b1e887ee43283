import base64
import gzip
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from typing import get_args

import pytest
from sample_document import HOSTILE, curves, document, playback

from runner.reporting import html
from runner.reporting.document import Block, Document, Section, Text
from runner.reporting.markup import spans
from runner.reporting.templating import html_environment
from runner.texts import plain


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
    return Page(html.render(document("words")))


@pytest.mark.parametrize("kind", get_args(Block), ids=lambda kind: kind.block)
def test_every_block_type_has_a_macro(kind):
    blocks = html_environment().get_template("blocks.html.j2").make_module({})
    assert callable(getattr(blocks, kind.block))


@pytest.mark.parametrize("text", HOSTILE)
def test_texts_add_no_tag_and_are_shown_literally(quiet, text):
    page = Page(html.render(document(text)).encode("utf-8", "replace").decode())
    extra = {"img", "code", "br"}  # mathematics, or its source where it is refused
    assert [tag for tag in page.tags if tag not in extra] == [tag for tag in quiet.tags if tag not in extra]
    assert not any(name.startswith("on") for name, _ in page.attributes)
    if not any(span.math for span in spans(text)):
        literal = " ".join(plain(text).replace("$$", "$").split())
        assert literal in " ".join(page.shown.split())


def test_no_text_can_end_a_script():
    page = Page(html.render(document("</script><!--\u2028")))
    data = [content for attributes, content in page.scripts if attributes.get("type") == "application/json"]
    assert len(data) == 4  # curves, maps, runs, palette
    for content in data:
        json.loads(content)
        assert "\u2028" not in content


def test_nothing_is_asked_from_the_network():
    text = html.render(document())
    assert not re.findall(r"(?<!<a )(?:src|href)=[\"']?(?:https?:)?//", text)  # a link waits for a click
    assert "default-src 'none'" in text


def test_plotly_stands_once_and_only_where_curves_are():
    with_two = Document("", "", "", [Section("", [curves(), curves()])], "")
    without = Document("", "", "", [Section("", [Text("no curves")])], "")
    assert html.render(with_two).count('id="plotly"') == 1
    assert 'id="plotly"' not in html.render(without)
    packed = Page(html.render(with_two))
    (library,) = [content for attributes, content in packed.scripts if attributes.get("id") == "plotly"]
    assert b"Plotly" in gzip.decompress(base64.b64decode(library))


def test_playbacks_share_one_player():
    page = html.render(Document("", "", "", [Section("", [playback(), playback(90)])], ""))
    assert page.count('id="player"') == 1
    assert page.count('class="play"') == 2


def test_formulas_are_images_with_their_words():
    page = html.render(Document("", "", "$omega_n$", [], ""))
    assert re.search(r'<img class="math" role="img" alt="omega_n" aria-label="omega_n" src="data:image/svg', page)


def test_the_same_document_gives_the_same_page():
    assert html.render(document()) == html.render(document())


def test_sections_are_numbered_and_listed():
    page = Page(html.render(replace(document(), sections=[Section("A", [], [Section("B")]), Section("C")])))
    assert [value for name, value in page.attributes if name == "href" and value.startswith("#s")] == [
        "#s1",
        "#s1-1",
        "#s2",
    ]
