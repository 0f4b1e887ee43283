"""Repetitions that keep a spec, from only values."""

import json

import numpy as np
import pytest

from runner.config.judgement import Bound
from runner.statistics.spec import bounds_of, judge, read_spec

VALUES = {
    "settling_time": np.array([1.0, 2.0, np.nan, 1.5]),
    "overshoot": np.array([0.3, 0.1, 0.1, np.nan]),
}


def judged(**bounds):
    given = {name: Bound(**bound) for name, bound in bounds.items()}
    return judge(given, 4, VALUES, VALUES.__getitem__)


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
    spec = judge({"overshoot": Bound(max=1.0)}, 7, {}, VALUES.__getitem__)
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
