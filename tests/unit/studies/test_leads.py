"""Leads of one law on another: p-values against the exact signed-rank law, and both sides of the least lead."""

import numpy as np
import pytest

from runner.papers.studies.benchmark.cells import LawInCell, Lead, leads

APART = np.arange(0.1, 0.65, 0.1)  # logarithms of ratios, one for each of six seeds
ONE_TURNED = APART * [-1.0, 1.0, 1.0, 1.0, 1.0, 1.0]  # the smallest of them has the other sign


def entry(law: str, *logarithms: np.ndarray) -> LawInCell:
    """Return a law with the logarithms of its errors along one path, an array for each tuning."""
    return LawInCell(law, np.exp(np.array(logarithms))[:, None, :])


def lead_of(a: LawInCell, b: LawInCell) -> Lead:
    return leads({"wind": [a, b]})["wind"][a.law, b.law]


def test_the_p_value_is_the_largest_of_all_tunings() -> None:
    """Of 2^6 choices of signs, 2 lie as far out as six equal signs, and 4 as far as the smallest one turned."""
    b = entry("b", np.zeros(6))
    assert lead_of(entry("a", -APART, -APART), b).p_value == pytest.approx(2 / 64)
    for tunings in ((-APART, -ONE_TURNED), (-ONE_TURNED, -APART)):
        lead = lead_of(entry("a", *tunings), b)
        assert lead.p_value == pytest.approx(4 / 64)
        assert not lead.shown


@pytest.mark.parametrize(
    ("ratio", "shown"), [(0.97, False), (1.0, False), (1.01, False), (1.0204, False), (1.0205, True)]
)
def test_where_nothing_is_drawn_a_lead_is_more_than_two_hundredths(ratio: float, shown: bool) -> None:
    lead = lead_of(LawInCell("a", np.ones((2, 1, 1))), LawInCell("b", np.full((2, 1, 1), ratio)))
    assert (lead.shown, lead.factor, lead.p_value) == (shown, pytest.approx(ratio), None)


@pytest.mark.parametrize(("ratio", "shown"), [(1.005, False), (1.0203, False), (1.0205, True)])
def test_between_seeds_the_difference_is_above_two_hundredths(ratio: float, shown: bool) -> None:
    lead = lead_of(entry("a", APART), entry("b", APART + np.log(ratio) + 1e-6 * APART))
    assert lead.interval == pytest.approx((ratio, ratio), rel=1e-5)
    assert lead.p_value == pytest.approx(2 / 64)
    assert lead.shown == shown
