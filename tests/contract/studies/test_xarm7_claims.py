"""Claims on the tip's motion: the xArm7 report's."""

import numpy as np
import pytest
from pydantic import ValidationError

from runner.config.compose.files import group_options
from runner.papers.reporting.published_claims import CONTRADICTION, Extent, PublishedClaim, judge_motion, load_claims
from runner.store.baselines import shipped_baselines

CLAIMS = load_claims("xarm7")
T = np.linspace(0.0, 2.0 * np.pi, 101)
LINE = np.column_stack([np.full(101, 0.643), -0.2 * np.cos(T), np.full(101, 0.1508)])
Y = Extent(axis="y", span=0.4, tolerance=5e-3)
X = Extent(axis="x", span=0.0, middle=0.643, tolerance=5e-4)


def moved(x=0.0, y=1.0, z=0.0):
    return LINE * [1.0, y, 1.0] + [x, 0.0, z]


def test_they_are_listed_in_order():
    assert [claim.number for claim in CLAIMS] == list(range(1, 8))
    assert [claim.printed for claim in CLAIMS] == [[0.643], [0.1508], [0.4], [], [], [], []]
    assert [claim.number for claim in CLAIMS if claim.fails] == [7]


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: str(claim.number))
def test_each_names_an_experiment_and_where_it_stands(claim):
    assert claim.experiment in group_options("experiment")
    assert claim.place.startswith("section ")
    assert claim.reason
    assert claim.extents


def test_every_experiment_that_works_has_a_reference():
    working = {claim.experiment for claim in CLAIMS if not claim.fails}
    assert {f"{name}.{preset}" for name in working for preset in ("full_equations", "as_reported")} <= set(
        shipped_baselines()
    )


@pytest.mark.parametrize(
    ("extent", "path", "met"),
    [
        (X, LINE, True),
        (X, moved(x=4.9e-4), True),
        (X, moved(x=5.1e-4), False),
        (X, LINE + 1e-3 * (T > 3.0)[:, None], False),
        (Y, LINE, True),
        (Y, moved(y=1.012), True),
        (Y, moved(y=1.013), False),
        (Y, moved(y=0.0), False),
        (Extent(axis="y", span=0.4, middle=0.0, tolerance=5e-3), moved(y=1.012), True),
        (Extent(axis="y", span=0.4, middle=0.01, tolerance=5e-3), LINE, False),
        (Y, np.where(T[:, None] > 6.0, np.nan, LINE), False),
    ],
)
def test_an_extent_is_met_within_its_tolerance(extent, path, met):
    assert extent.met(path) == met


def test_what_contradicts_the_desired_path_cannot_hold():
    along_x = [Extent(axis="y", span=0.0, tolerance=5e-3)]
    assert judge_motion(along_x, False, LINE, LINE) == CONTRADICTION
    assert judge_motion(along_x, False, moved(y=0.0), LINE) == CONTRADICTION


def test_a_tip_that_leaves_the_line_is_worse():
    assert judge_motion([X, Y], False, LINE, LINE) == "matches"
    assert judge_motion([X, Y], False, moved(x=1e-3), LINE) == "differs"


def test_a_failure_that_is_told_holds_when_it_fails():
    assert judge_motion([X, Y], True, moved(y=0.1), LINE) == "matches"
    assert judge_motion([X, Y], True, LINE, LINE) == "differs"


def test_a_claim_is_compared_in_one_way():
    entry = CLAIMS[0].model_dump()
    with pytest.raises(ValidationError, match="by metric or by extents"):
        PublishedClaim.model_validate(entry | {"metric": "energy"})
    with pytest.raises(ValidationError, match="by metric or by extents"):
        PublishedClaim.model_validate(entry | {"extents": []})
