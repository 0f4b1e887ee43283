"""Parts of what caveat rules say: shares and names of joints, and the record of what was found."""

from types import SimpleNamespace

import pytest

from runner.caveats.rule import Caveat, Found, called, percent


@pytest.mark.parametrize(("share", "text"), [(0.125, "12.5 %"), (1.0, "100 %"), (0.0, "0 %"), (1 / 3, "33.3 %")])
def test_shares_are_percentages_of_three_digits(share, text):
    assert percent(share) == text


@pytest.mark.parametrize(("joint", "text"), [(0, "joint q1"), (1, "joint2")])
def test_a_joint_is_called_one_once(joint, text):
    assert called(joint, SimpleNamespace(joint_names=["q1", "joint2"])) == text


def test_the_record_has_caveats_rules_and_thresholds():
    found = Found([Caveat("saturation", "too much", 0.5)], "abc", {"saturation": {"share": 0.1}})
    assert found.record() == {
        "caveats": [{"rule": "saturation", "text": "too much", "value": 0.5}],
        "caveat_rules": {"digest": "abc", "thresholds": {"saturation": {"share": 0.1}}},
    }
