"""Markup in strings: mathematics, links, literals."""

import pytest

from runner.base.sanitize import plain
from runner.reporting.markup import Span, link_text, mark_text, spans, without_marks


def test_dollars_enclose_mathematics():
    assert spans("sag $g / omega_n^2$ here") == [Span("sag "), Span("g / omega_n^2", math=True), Span(" here")]


@pytest.mark.parametrize(
    ("text", "shown"),
    [("$$5 and $$6", "$5 and $6"), ("lone $ sign", "lone $ sign"), ("", "")],
)
def test_other_dollars_are_literal(text, shown):
    assert "".join(span.text for span in spans(text)) == shown
    assert not any(span.math for span in spans(text))


def test_a_section_sign_with_a_number_is_a_link():
    assert spans("see §2.1, not § 3") == [Span("see "), Span("section 2.1", anchor="s2-1"), Span(", not § 3")]


def test_claims_figures_and_tables_are_links():
    assert spans("Claim 3 and figure 5.12, not figures 2") == [
        Span("Claim 3", anchor="claim-3"),
        Span(" and "),
        Span("figure 5.12", anchor="figure-5-12"),
        Span(", not figures 2"),
    ]


def test_plain_text_has_no_marks():
    link = link_text("a page", "https://example.org")
    text = f"{mark_text('so', 'emphasis')}: {mark_text('a_b', 'code')} costs $$5, $x^2$, see {link}, §2.1 and claim 3"
    plain_text = "so: `a_b` costs $5, $x^2$, see a page (https://example.org), section 2.1 and claim 3"
    assert without_marks(text) == plain_text


def test_plain_is_one_line():
    assert plain("a\r\n\tb   c\u2028d") == "a b c d"


@pytest.mark.parametrize("character", ["\x00", "\x1b", "\ud800", "\u202e", "\ufffe"])
def test_plain_replaces_what_no_file_can_hold(character):
    assert plain(f"a{character}b") == "a\ufffdb"
