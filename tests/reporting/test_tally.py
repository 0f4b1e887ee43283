"""Verdicts of a report counted, with their places."""

from support.sample_document import equations

from runner.reporting.claim import Claim, ClaimResult
from runner.reporting.document import Document, Section, Verdicts
from runner.reporting.tally import tallies


def claim(number, *verdicts):
    return Claim(
        number, "It holds", "page 1", "1", [ClaimResult(v, "1", v, f"way {i}") for i, v in enumerate(verdicts)], ""
    )


def test_verdicts_are_counted_for_each_way_with_the_place_of_each_claim():
    rows = [claim("1", "holds", "better"), claim("2", "worse", "better"), claim("3", "holds", "worse")]
    first, second = tallies(Document("", "", "", [Section("A", [Verdicts("All.", rows)])], ""))
    assert (first.way, first.words) == ("way 0", "2 of 3 hold, 1 worse")
    assert first.squares == (
        ("1", "holds", "claim-1", "Claim 1: holds"),
        ("2", "worse", "claim-2", "Claim 2: worse"),
        ("3", "holds", "claim-3", "Claim 3: holds"),
    )
    assert (second.way, second.words) == ("way 1", "2 of 3 better, 1 worse")


def test_equations_are_counted_alone():
    (found,) = tallies(Document("", "", "", [Section("A", [equations("x", source="paper")])], ""))
    assert found.squares == (
        ("1", "wrong as printed", "paper-wrong-as-printed", "1 wrong as printed"),
        ("1", "correct", "paper-correct", "1 correct"),
    )
    assert sum(count for _, count in found.counts) == len(equations("x").rows)


def test_a_report_without_claims_has_none():
    assert tallies(Document("", "", "", [], "")) == []
