"""A claim judged by simulated values that are given."""

from collections.abc import Mapping

import pytest

from runner.papers.reporting.published_claims import (
    CONTRADICTION,
    PublishedClaim,
    Simulated,
    compared_with,
    expected_value,
    load_claims,
    verdict_on,
)

CLAIMS = load_claims("thesis")
TIME, ERROR, BOUNDED, ALIKE = (next(each for each in CLAIMS if each.number == number) for number in (1, 4, 5, 16))


def given(values: Mapping[str, float | None]) -> Simulated:
    return lambda run, _metric: values[run]


@pytest.mark.parametrize(
    ("value", "verdict"),
    [(0.044, "matches"), (0.01, "smaller than printed"), (0.1, "larger than printed"), (None, "larger than printed")],
)
def test_a_number_is_held_against_the_printed_one(value: float | None, verdict: str) -> None:
    assert verdict_on(ERROR, CLAIMS, given({"figure_3_10": value})) == verdict


@pytest.mark.parametrize(("like", "verdict"), [(0.1, "matches"), (0.01, "differs"), (1.0, "differs"), (None, None)])
def test_a_likeness_is_held_against_the_other_run(like: float | None, verdict: str | None) -> None:
    simulated = given({"figure_5_13": 0.11, "macro_alone": like})
    assert compared_with(ALIKE, simulated) == like
    assert verdict_on(ALIKE, CLAIMS, simulated) == verdict


@pytest.mark.parametrize(
    ("macro", "bound", "verdict"), [(1.3, 0.14, CONTRADICTION), (2.5, 0.25, "matches"), (None, 0.14, CONTRADICTION)]
)
def test_a_bound_is_the_larger_of_what_is_printed_and_simulated(
    macro: float | None, bound: float, verdict: str
) -> None:
    simulated = given({"figure_3_5": macro, "figure_4_2": 0.3})
    assert expected_value(BOUNDED, CLAIMS, simulated) == pytest.approx(bound)
    assert verdict_on(BOUNDED, CLAIMS, simulated) == verdict


def test_most_claims_have_no_bound() -> None:
    assert expected_value(TIME, CLAIMS, given({})) is None


def test_a_claim_names_its_experiment_or_its_run() -> None:
    assert TIME.simulated_by == ("figure_3_5", "settling_time")
    for run in ("goal", "stiff/f20"):  # a run, and one cell of a grid with two axes
        named = PublishedClaim.model_validate(TIME.model_dump() | {"experiment": "", "run": run})
        assert named.simulated_by == (run, "settling_time")
