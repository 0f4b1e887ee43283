"""Findings and their conditions: comparisons, words, and those that no longer hold."""

import numpy as np
import pytest

from runner.papers.study.measured import Measured, finding, findings
from runner.reporting.document import Document, Section, Text

SLOW, FAST = Measured("error of the slow one", 4e-3, "m"), Measured("error of the fast one", 1e-3, "m")


def test_a_comparison_says_itself_in_words_with_its_values():
    condition = SLOW > 3.0 * FAST
    assert condition.holds
    assert condition.text == "error of the slow one > 3 times error of the fast one"
    assert condition.measured == "error of the slow one: 4 mm; error of the fast one: 1 mm"


def test_two_values_of_a_kind_have_one_unit():
    assert Measured("of the pair", 7.75e-4, "m").with_other(Measured("of the Macro", 0.108, "m")) == "0.775 and 108 mm"
    assert Measured("of the pair", 1.63, "s").with_other(Measured("of the Macro", 1.6, "s")) == "1.63 and 1.6 s"


@pytest.mark.parametrize(
    ("condition", "holds"),
    [
        (SLOW < FAST, False),
        (SLOW <= 4e-3, True),
        (SLOW >= 4e-3, True),
        (SLOW / FAST >= 4.0, True),
        (SLOW / 2.0 > FAST, True),
        (SLOW - FAST < 3.1e-3, True),
        ((SLOW / FAST).near(4.1, 0.05), True),
        ((SLOW / FAST).near(4.5, 0.05), False),
        (SLOW / Measured("nothing", 0.0, "m") > 1e9, True),
    ],
)
def test_comparisons_are_those_of_numbers(condition, holds):
    assert condition.holds is holds


@pytest.mark.parametrize("nothing", [None, np.nan])
def test_what_has_no_value_makes_every_condition_false(nothing):
    missing = Measured("settling time", nothing, "s")
    for condition in (missing < 3.0, missing >= 3.0, 2.0 * missing > 1.0, missing.near(1.0, 0.1), SLOW / missing > 0.0):
        assert not condition.holds
        assert "settling time: has no value" in condition.measured


def test_what_is_of_the_size_of_rounding_errors_is_told_as_such():
    tiny = Measured("distance from the line", 5.6e-17, "m")
    assert str(tiny) == "less than 1·10⁻¹² m"
    condition = tiny < 1e-13
    assert condition.text == "distance from the line < 1·10⁻¹³ m"
    assert condition.measured == "distance from the line: less than 1·10⁻¹² m"


def test_a_condition_chooses_no_words():
    with pytest.raises(TypeError, match="chooses no words"):
        _ = "slow" if SLOW > FAST else "fast"


def test_a_finding_stands_with_its_conditions():
    stands = finding("The slow one errs more", f"It errs by {SLOW}.", SLOW > FAST)
    assert (stands.kind, stands.title, stands.text) == ("finding", "The slow one errs more", "It errs by 4 mm.")
    assert stands.holds


def test_where_one_fails_it_says_which_and_what_had_been_written():
    fallen = finding("The slow one errs less", f"It errs by {SLOW}.", SLOW < FAST, SLOW > 1e-6)
    assert not fallen.holds
    assert fallen.kind == "warning"
    assert fallen.title == "No longer holds: The slow one errs less"
    assert fallen.text == (
        "Not so: error of the slow one < error of the fast one (error of the slow one: 4 mm; error of the fast "
        "one: 1 mm). It was written: It errs by 4 mm."
    )


def test_a_finding_needs_a_condition():
    with pytest.raises(ValueError, match="needs one condition or more"):
        finding("So it is", "It is so.")


def test_findings_of_a_report_are_found_with_their_section():
    one = finding("The slow one errs more", "It does.", SLOW > FAST)
    inner = Section("Inner", (Text("some words"), one))
    document = Document("A", "B", "C", (Section("Outer", (), (inner,)), Section("Other", (one,))), "2026-01-01")
    assert [number for number, _ in findings(document)] == ["1.1", "2"]
