"""Verdicts of a report counted, with their places."""

from support.sample_document import equations

from runner.papers.reporting.claims import Claim, ClaimResult, Verdicts, find_conditional_claims
from runner.reporting.document import Document, Section
from runner.reporting.outline import tallies


def claim(number, *verdicts):
    return Claim(
        number, "It holds", "page 1", "1", [ClaimResult(v, "1", v, f"way {i}") for i, v in enumerate(verdicts)], ""
    )


def test_verdicts_are_counted_for_each_way_with_the_place_of_each_claim():
    rows = [
        claim("1", "matches", "smaller than printed"),
        claim("2", "larger than printed", "smaller than printed"),
        claim("3", "matches", "larger than printed"),
    ]
    first, second = tallies(Document("", "", "", [Section("A", [Verdicts("All.", rows)])], ""))
    assert (first.way, first.words) == ("way 0", "2 of 3 match, 1 larger than printed")
    assert first.squares == (
        ("1", "matches", "claim-1", "Claim 1: matches"),
        ("2", "larger than printed", "claim-2", "Claim 2: larger than printed"),
        ("3", "matches", "claim-3", "Claim 3: matches"),
    )
    assert (second.way, second.words) == ("way 1", "2 of 3 smaller than printed, 1 larger than printed")


def test_a_verdict_that_hangs_on_something_has_a_star_and_a_line():
    found = ClaimResult("", "1", "matches", hangs={"the engine": "2 s"})
    verdicts = Verdicts("All.", [Claim("7", "It holds", "page 1", "1", [found], ""), claim("8", "matches")])
    (tally,) = tallies(Document("", "", "", [Section("A", [verdicts])], ""))
    assert [square[0] for square in tally.squares] == ["7*", "8"]
    assert tally.squares[0].words == "Claim 7: matches; depends on the engine"
    assert find_conditional_claims([verdicts]) == "* Verdicts that depend on the engine: claim 7."
    assert find_conditional_claims([Verdicts("All.", [claim("8", "matches")])]) == ""


def test_equations_are_counted_alone():
    (found,) = tallies(Document("", "", "", [Section("A", [equations("x", source="paper")])], ""))
    assert found.squares == (
        ("1", "wrong as printed", "paper-wrong-as-printed", "1 wrong as printed"),
        ("1", "correct", "paper-correct", "1 correct"),
    )
    assert sum(count for _, count in found.counts) == len(equations("x").rows)


def test_a_report_without_claims_has_none():
    assert tallies(Document("", "", "", [], "")) == []
