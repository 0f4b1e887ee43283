"""Ranges of tuned keys: read, refused, and values kept on their grid."""

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser

from runner.base.errors import ConfigError
from runner.sweeps.tuning.key import TunedKey, read_key


def read(text):
    return read_key(OverridesParser.create().parse_override(text))


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("a.b=interval(1,5)", TunedKey("a.b", 1.0, 5.0, None, False, False)),
        ("++a=tag(log,interval(1e-4,1e-2))", TunedKey("a", 1e-4, 1e-2, None, True, False)),
        ("a=int(interval(1,5))", TunedKey("a", 1, 5, None, False, True)),
        ("a=tag(log,int(interval(1,100)))", TunedKey("a", 1, 100, None, True, True)),
        ("a=range(1,9,2)", TunedKey("a", 1, 7, 2, False, True)),
        ("a=range(0.01,0.045,0.01)", TunedKey("a", 0.01, 0.04, 0.01, False, False)),
    ],
)
def test_ranges_are_read(text, key):
    assert read(text) == key


@pytest.mark.parametrize("text", ["a=5", "a=null", "a=[1,2]", "a=xy", "~a"])
def test_one_value_is_no_range(text):
    assert read(text) is None


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("a=interval(5,5)", "a: its range is empty, 5 to 5; low must be below high"),
        ("a=interval(5,1)", "a: its range is empty, 5 to 1"),
        ("a=range(5,5)", "a: its range is empty; 5 to 5 has no two values"),
        ("a=range(5,6)", "a: its range is empty; 5 to 6 has no two values"),
        ("a=tag(log,interval(0,5))", "a: on a logarithmic scale low must be above 0; found 0"),
        ("a=interval(0,inf)", "a: its range must be finite; found 0 to inf"),
        ("a=1,2", "'a=1,2' is not a range to tune in; ranges: interval"),
        ("a=choice(1,2)", "is not a range to tune in"),
        ("a=tag(lin,interval(1,2))", "is not a range to tune in"),
        ("a=tag(log,range(1,5))", "is not a range to tune in"),
    ],
)
def test_what_cannot_be_tuned_is_told(text, why):
    with pytest.raises(ConfigError) as error:
        read(text)
    assert why in str(error.value)


def test_values_stay_in_range_and_on_their_grid():
    frequency = TunedKey("a", 0.1, 2.0 / 3.0, None, False, False)
    assert frequency.value(2.0 / 3.0) == 2.0 / 3.0
    assert frequency.value(0.123456789123) == 0.123456789
    period = TunedKey("a", 0.01, 0.04, 0.01, False, False)
    assert [period.value(value) for value in (0.01, 0.0249, 0.0251, 0.01 + 2 * 0.01)] == [0.01, 0.02, 0.03, 0.03]
    whole = TunedKey("a", 1, 7, 2, False, True)
    assert repr(whole.value(4.4)) == "5"
    assert repr(TunedKey("a", 1, 100, None, True, True).value(7.6)) == "8"


def test_probes_are_both_ends_and_a_value_that_nobody_would_type():
    low, between, high = TunedKey("a", 1.0, 100.0, None, True, False).probes
    assert (low, high) == (1.0, 100.0)
    assert between == pytest.approx(10 ** (2 * 0.618))
    assert not float(TunedKey("a", 1.0, 5.0, None, False, False).probes[1]).is_integer()
    assert TunedKey("a", 1, 5, None, False, True).probes == (1, 3, 5)


@pytest.mark.parametrize(
    ("log", "value", "end"),
    [
        (False, 1.0, "lower"),
        (False, 2.9, "lower"),
        (False, 3.1, None),
        (False, 98.9, None),
        (False, 99.1, "upper"),
        (True, 1.09, "lower"),
        (True, 1.10, None),
        (True, 91.0, None),
        (True, 92.0, "upper"),
    ],
)
def test_a_value_is_near_an_end_within_two_per_cent_of_the_range_on_its_scale(log, value, end):
    assert TunedKey("a", 1.0, 101.0 if not log else 100.0, None, log, False).end_near(value) == end


def test_the_override_gives_the_very_value():
    value = 0.1 + 0.2
    assert float(TunedKey("a.b", 0.0, 1.0, None, False, False).override(value).partition("=")[2]) == value
