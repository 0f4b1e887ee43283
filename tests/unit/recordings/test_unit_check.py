"""Factors that look like another unit, against motions of known size."""

import math

import numpy as np
import pytest

from runner.recordings.columns_map import Factor, Signal, other_units

RUN = 0.2 + np.sin(np.linspace(0.0, 9.0, 200))
DEG = Factor(math.pi / 180.0, "rad")


def asked(signal, multiple, factor, noise=0.0):
    values = multiple * RUN + noise * np.random.default_rng(0).normal(size=200)
    return list(other_units({signal: values}, {signal: RUN}, {signal: "a"}, {"a": factor}))


@pytest.mark.parametrize(
    ("kind", "multiple", "factor", "unit"),
    [
        ("position", 180.0 / math.pi, Factor(1.0, "rad"), "deg"),
        ("position", math.pi / 180.0, DEG, "rad"),
        ("position", 1000.0, Factor(1.0, "rad"), "mrad"),
        ("position", 1000.0, Factor(1.0, "m"), "mm"),
        ("tip", 0.001, Factor(1e-3, "m"), "m"),
        ("tip", 100.0, Factor(1.0, "m"), "cm"),
        ("torque", 1000.0, Factor(1.0, "N m"), "mN m"),
        ("torque", -1e-3, Factor(1.0, "N m"), "kN m"),
    ],
)
def test_a_factor_of_another_unit_is_asked_about(kind, multiple, factor, unit):
    (question,) = asked(Signal(kind, "x"), multiple, factor)
    assert question.endswith(f"the column looks like {unit}: say unit: {unit}")
    assert question.startswith("columns.a: the ")


def test_what_another_arm_may_do_is_not_asked_about():
    signal = Signal("position", "q1")
    assert asked(signal, 3.0, Factor(1.0, "rad")) == []
    assert asked(signal, 57.3, Factor(1.0, "rad"), noise=100.0) == []  # it does not follow the run
    assert asked(signal, 8.0, Factor(1.0, "rad")) == []  # a factor of no unit
    assert asked(signal, 0.0, Factor(1.0, "rad")) == []
