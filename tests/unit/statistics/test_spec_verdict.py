"""Verdict on a probability of failing, from some repetitions, against exact bounds."""

import numpy as np
import pytest

from runner.statistics.proportion import count_share
from runner.statistics.spec.kept import Verdict, judge_share


@pytest.mark.parametrize(("failed", "says"), [(0, "kept"), (1, "broken")])
def test_without_a_probability_no_repetition_may_fail(failed, says):
    assert judge_share(count_share(1000 - failed, 1000), None) == Verdict(says)


@pytest.mark.parametrize(("failed", "says"), [(0, "kept"), (3, "kept"), (5, "untold"), (30, "broken")])
def test_the_whole_interval_has_to_lie_below(failed, says):
    share = count_share(1000 - failed, 1000)
    verdict = judge_share(share, 0.01)
    assert verdict.says == says
    assert (share.rest.high < 0.01, share.rest.low > 0.01) == (says == "kept", says == "broken")


def test_too_few_name_how_many_would_do():
    assert judge_share(count_share(1000, 1000), 1e-4) == Verdict("untold", 36_887)
    assert judge_share(count_share(990, 1000), 0.01) == Verdict("untold", None)


@pytest.mark.parametrize("failed", [0, 7])
def test_an_end_of_the_interval_at_the_probability_itself_tells_nothing(failed):
    share = count_share(1000 - failed, 1000)
    low, high = share.rest.low, share.rest.high
    assert judge_share(share, high).says == "untold"
    assert judge_share(share, np.nextafter(high, 1.0)).says == "kept"
    if failed:
        assert judge_share(share, low).says == "untold"
        assert judge_share(share, np.nextafter(low, 0.0)).says == "broken"
