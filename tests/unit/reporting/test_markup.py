"""Markup in texts: mathematics, links, literals."""

import pytest

from runner.base.sanitize import plain
from runner.reporting.markup import Link, Literal, Math, spans


def test_dollars_enclose_mathematics():
    assert spans("sag $g / omega_n^2$ here") == [Literal("sag "), Math("g / omega_n^2"), Literal(" here")]


@pytest.mark.parametrize(
    ("text", "shown"),
    [("$$5 and $$6", "$5 and $6"), ("lone $ sign", "lone $ sign"), ("", "")],
)
def test_other_dollars_are_literal(text, shown):
    assert "".join(span.text for span in spans(text)) == shown
    assert not any(isinstance(span, Math) for span in spans(text))


def test_a_section_sign_with_a_number_is_a_link():
    assert spans("see §2.1, not § 3") == [Literal("see "), Link("section 2.1", "s2-1"), Literal(", not § 3")]


def test_claims_figures_and_tables_are_links():
    assert spans("Claim 3 and figure 5.12, not figures 2") == [
        Link("Claim 3", "claim-3"),
        Literal(" and "),
        Link("figure 5.12", "figure-5-12"),
        Literal(", not figures 2"),
    ]


def test_plain_is_one_line():
    assert plain("a\r\n\tb   c\u2028d") == "a b c d"


@pytest.mark.parametrize("character", ["\x00", "\x1b", "\ud800", "\u202e", "\ufffe"])
def test_plain_replaces_what_no_file_can_hold(character):
    assert plain(f"a{character}b") == "a\ufffdb"
