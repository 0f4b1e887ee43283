"""Pairwise covers of options: every pair of values against the full product."""

import itertools

import pytest
from support.covers import SWITCH, covered, every_case, name_of, pairwise

MIXED = {"law": ("a", "b", "c", "d", "e"), "damped": SWITCH, "rate": (1, 2, 3), "late": SWITCH, "single": ("only",)}


def pairs_of(cases):
    return {frozenset(pair) for case in cases for pair in itertools.combinations(case.items(), 2)}


@pytest.mark.parametrize("options", [MIXED, dict.fromkeys("abcdefghij", SWITCH), {"a": SWITCH, "b": SWITCH}], ids=len)
def test_each_two_values_of_two_options_meet(options):
    cases = pairwise(options)
    assert pairs_of(cases) == pairs_of(every_case(options))
    assert all(list(case) == list(options) for case in cases)
    assert pairwise(options) == cases


def test_a_cover_is_small():
    assert len(pairwise(dict.fromkeys("abcdefghij", SWITCH))) <= 12  # of 1024
    assert len(pairwise(MIXED)) <= 18  # of 60; 15 is the least


def test_all_cases_are_parameters_and_those_beyond_the_cover_are_slow():
    given = covered(MIXED)
    assert [each.values[0] for each in given] == every_case(MIXED)
    quick = [each.values[0] for each in given if not each.marks]
    assert len(quick) == len(pairwise(MIXED))
    assert pairs_of(quick) == pairs_of(every_case(MIXED))
    assert all(mark.name == "slow" for each in given for mark in each.marks)
    assert len({each.id for each in given}) == len(given)


def test_a_case_is_named_by_its_switches_that_are_on_and_its_values():
    assert name_of({"late": True, "damped": False, "law": "a", "rate": 2}) == "late-a-2"
    assert name_of({"late": False}) == "none"
