"""Repetitions within bounds, verdicts on bounds, and the history of bounds."""

import json
import re

import numpy as np
import pytest

from runner.base.machine import today
from runner.schema.bound import Bound
from runner.statistics.proportion import count_share
from runner.statistics.spec import (
    Verdict,
    bounds_of,
    ends_of,
    judge,
    judge_share,
    merge_histories,
    read_spec,
    set_after,
    settings,
)

VALUES = {
    "settling_time": np.array([1.0, 2.0, np.nan, 1.5]),
    "overshoot": np.array([0.3, 0.1, 0.1, np.nan]),
}


def judged(**bounds):
    given = {name: Bound(**bound) for name, bound in bounds.items()}
    return judge(given, 4, VALUES, VALUES.__getitem__, exact=False)


def kept(spec):
    return [None if one.share is None else one.share.kept for one in spec.bounds]


def test_ends_are_included_and_no_value_keeps_no_bound():
    spec = judged(settling_time={"max": 1.5}, overshoot={"min": 0.1, "max": 0.2})
    assert kept(spec) == [2, 2]
    assert [one.share.of for one in spec.bounds] == [4, 4]


@pytest.mark.parametrize("bound", [{"max": 1e6}, {"min": -1e6}])
def test_a_repetition_without_a_value_breaks_even_the_widest_bound(bound):
    assert kept(judged(settling_time=bound)) == [3]


def test_all_bounds_are_kept_by_the_same_repetitions():
    spec = judged(settling_time={"max": 1.5}, overshoot={"max": 0.2})
    assert kept(spec) == [2, 2]
    assert (spec.whole.kept, spec.failing.kept) == (0, 4)


def test_a_metric_that_the_run_lacks_is_not_judged():
    spec = judged(settling_time={"max": 1.5}, max_tracking_error={"max": 1.0})
    assert kept(spec) == [2, None]
    assert (spec.whole, spec.failing, spec.lacking) == (None, None, ["max_tracking_error"])


def test_a_run_of_which_every_repetition_failed_keeps_nothing():
    spec = judge({"overshoot": Bound(max=1.0)}, 7, {}, VALUES.__getitem__, exact=False)
    assert (spec.whole.kept, spec.whole.of) == (0, 7)


def test_what_is_stored_is_read_again():
    spec = judged(settling_time={"max": 1.5, "reason": "the line's beat"}, max_tracking_error={"max": 1.0})
    stored = json.loads(json.dumps(spec.record()))
    assert read_spec(stored) == spec
    assert stored["bounds"]["settling_time"]["share"] == 0.5
    assert stored["all"]["kept"] is None


def test_bounds_come_from_the_config():
    bound = {"min": None, "max": 2, "reason": ""}
    assert bounds_of({"spec": {"metrics": {"overshoot": bound}}}) == {"overshoot": Bound(max=2.0)}
    assert bounds_of({}) == {}  # of a run from before there were any


LOW, HIGH = Bound(max=1.0), Bound(min=0.5, max=2.0)


def test_a_history_begins_with_the_bound_and_its_date():
    assert settings({"a": LOW, "b": None}, "2026-01-02") == {
        "a": [["2026-01-02", [None, 1.0]]],
        "b": [["2026-01-02", [None, None]]],
    }
    assert re.fullmatch(r"\d{4}-\d{2}-\d{2}", today())


def test_of_equal_values_the_first_date_stays():
    days = ("2026-01-01", "2026-01-02", "2026-01-03")
    merged = merge_histories(*(settings({"a": bound}, day) for bound, day in zip((LOW, HIGH, LOW), days, strict=True)))
    assert merged == {"a": [["2026-01-01", ends_of(LOW)], ["2026-01-02", ends_of(HIGH)]]}


@pytest.mark.parametrize(
    ("bound", "found"),
    [(LOW, ("", ())), (HIGH, ("2026-01-02", [ends_of(LOW)])), (Bound(max=9.0), ("", ()))],
)
def test_only_a_later_value_is_set_after_the_result(bound, found):
    history = [["2026-01-01", ends_of(LOW)], ["2026-01-02", ends_of(HIGH)]]
    assert set_after(history, ends_of(bound)) == found


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
