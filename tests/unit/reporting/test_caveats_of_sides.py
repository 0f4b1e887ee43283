"""Caveats of the sweeps that are compared, counted by rule."""

from dataclasses import replace

from support.sample_sides import LAWS, side

from runner.reporting.comparison.operand import SideCaveat, caveats_of


def test_each_rule_is_counted_and_its_worst_is_told():
    def caveat(rule, value):
        return {"rule": rule, "text": f"{rule} {value}", "value": value}

    one = side("A", LAWS, lambda *_: 1.0)
    found = [
        [caveat("chatter", 0.2)],
        [caveat("saturation", 0.1), caveat("chatter", 0.9)],
        [],
        [caveat("chatter", 0.3)],
    ]
    doubted = replace(one, measurements=replace(one.measurements, caveats=found))
    assert caveats_of(one) == []
    assert caveats_of(doubted) == [
        SideCaveat("A", "chatter", 3, 4, "chatter 0.9"),
        SideCaveat("A", "saturation", 1, 4, "saturation 0.1"),
    ]
