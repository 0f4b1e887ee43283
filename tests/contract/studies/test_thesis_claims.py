"""The thesis' claims: listed in order, each with a metric that exists, its place and its reason."""

import pytest
from pydantic import ValidationError

from runner.config.compose.files import group_options
from runner.papers.reporting.published_claims import CONTRADICTION, FACTOR, PublishedClaim, judge, load_claims
from runner.plugins.metric_units import unit_of

CLAIMS = load_claims("thesis")
PAIRS = [(claim, where) for claim in CLAIMS for where in (claim, claim.like) if where is not None]


def test_the_numbers_of_chapters_3_to_5_are_listed_in_order():
    assert [claim.number for claim in CLAIMS] == list(range(1, 18))
    assert [claim.printed for claim in CLAIMS] == [
        [1.4],
        [0.0, 9e-3],
        [0.1, 0.15],
        [0.007, 0.044],
        [0.3],
        [4e-4, 8e-4],
        [6e-5],
        [1.0],
        [0.0, 4e-4],
        [1.5],
        [0.0, 9e-4],
        [0.01],
        [0.06],
        [0.0, 5e-4],
        [0.0, 0.01],
        [],  # a string
        [0.0, 9e-3],
    ]


@pytest.mark.parametrize(("claim", "where"), PAIRS, ids=lambda value: getattr(value, "experiment", ""))
def test_a_claim_is_compared_with_a_metric_of_an_experiment_that_exists(claim, where, checked_config):
    assert where.experiment in group_options("experiment")
    assert unit_of(where.metric) == claim.unit
    config = checked_config(f"experiment={where.experiment}")
    assert config.settings.repetitions == 40
    tracked = config.resolved["trajectory"]["kind"] != "goal"
    assert tracked or "tracking" not in where.metric  # such a metric is absent for a goal


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: str(claim.number))
def test_a_claim_says_where_it_stands_and_why(claim):
    assert claim.place.startswith("section ")
    assert claim.reason or claim.bound.reason
    assert claim.value == max(claim.printed, default=None)
    assert (claim.like is None) == bool(claim.printed)


def test_only_the_minis_settling_time_is_held_against_another_printed_number():
    bounded = [claim for claim in CLAIMS if claim.bound]
    assert [(claim.number, claim.bound.claim) for claim in bounded] == [(5, 1)]
    macro = CLAIMS[0]
    assert (macro.number, macro.unit) == (1, bounded[0].unit)
    assert FACTOR * bounded[0].bound.scale * macro.value < bounded[0].value  # only the source, without any run


def test_an_unknown_key_of_a_claim_is_refused():
    entry = CLAIMS[0].model_dump() | {"verdict": "matches"}
    with pytest.raises(ValidationError, match="verdict"):
        PublishedClaim.model_validate(entry)


@pytest.mark.parametrize(
    ("measured", "verdict"),
    [
        (2.0, "matches"),
        (2.0 * FACTOR, "matches"),
        (2.0 * FACTOR * (1 + 1e-12), "larger than printed"),
        (2.0 / FACTOR, "matches"),
        (2.0 / FACTOR * (1 - 1e-12), "smaller than printed"),
        (0.0, "smaller than printed"),
        (None, "larger than printed"),
    ],
)
def test_a_number_matches_within_a_factor(measured, verdict):
    assert judge(2.0, measured) == verdict


@pytest.mark.parametrize(
    ("measured", "bound", "verdict"),
    [
        (0.1, 0.1, CONTRADICTION),
        (None, 0.1, CONTRADICTION),
        (2.0, 2.0 / FACTOR * (1 - 1e-12), CONTRADICTION),
        (2.0, 2.0 / FACTOR, "matches"),
        (0.1, 10.0, "smaller than printed"),
        (None, 10.0, "larger than printed"),
        (2.0, None, "matches"),
    ],
)
def test_a_number_beyond_what_another_one_allows_contradicts_it(measured, bound, verdict):
    assert judge(2.0, measured, bound) == verdict
