"""Guarded metrics: if a metric fails, only its value is lost."""

import re
from types import ModuleType

import numpy as np
import pytest

from runner.base.errors import ConfigError, SimulationError
from runner.metrics.summary import evaluate
from runner.plugins import metric_units
from runner.simulation.loop import simulate
from runner.simulation.results import metric_context
from runner.simulation.sensors import make_encoders


@pytest.mark.parametrize(
    ("give", "value", "notice"),
    [
        (lambda: {"own": 2.0}, 2.0, None),
        (lambda: {"own": np.float64(2.0)}, 2.0, None),
        (lambda: {"own": None}, None, None),
        (lambda: {"own": float("nan")}, None, r"metric own: .*evaluate_own .* gave nan; it must be finite"),
        (lambda: {"own": np.zeros(2)}, None, r"metric own: .* gave an array of shape \(2,\); it must be a number"),
        (lambda: {"own": 1 / 0}, None, r"metrics of mine: ZeroDivisionError: .* \(test_metrics.py, line \d+"),
        (lambda: {"own": 2.0, "other": 1.0}, 2.0, r"metric other: mine.UNITS names no unit for it; it is left out"),
        (lambda: 3, None, r"metrics of mine: TypeError"),
        (
            lambda: {"own": 2.0, "own_peak_torque": 1.0},
            2.0,
            r"metric own_peak_torque: mine gave a metric of runner\.metrics\.effort; it is left out",
        ),
    ],
)
def test_a_metric_that_goes_wrong_has_no_value_and_the_others_stay(
    checked_config, closed_loop, monkeypatch, give, value, notice
):
    family = ModuleType("mine")
    family.UNITS = {"own": "m"}

    def evaluate_own(trace, context):
        return give()

    family.evaluate = evaluate_own
    monkeypatch.setattr(metric_units, "added_families", lambda: (family,))
    config = checked_config("robot=macro", "duration=0.1")
    loop = closed_loop("robot=macro", "duration=0.1")
    notices = []
    values = evaluate(
        simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0)), metric_context(config), notices
    )
    assert values["own"] == value
    assert "peak_torque" in values
    assert "other" not in values
    assert "own_peak_torque" not in values
    assert len(notices) == (notice is not None)
    if notice is not None:
        assert re.search(notice, notices[0]), notices[0]


@pytest.mark.parametrize("what", ["t", "q", "desired"])
def test_a_metric_that_changes_the_trace_is_a_failure_that_names_the_place(
    checked_config, closed_loop, monkeypatch, what
):
    family = ModuleType("mine")
    family.UNITS = {"own": "m"}

    def evaluate_own(trace, context):
        getattr(trace, what)[:] = 0.0

    family.evaluate = evaluate_own
    monkeypatch.setattr(metric_units, "added_families", lambda: (family,))
    config, loop = checked_config("robot=macro", "duration=0.1"), closed_loop("robot=macro", "duration=0.1")
    trace = simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0))
    with pytest.raises(SimulationError, match=r"metrics of mine: .*read-only \(test_metrics.py, line \d+, in evaluate"):
        evaluate(trace, metric_context(config))


def _family(name, *metrics):
    family = ModuleType(name)
    family.UNITS, family.evaluate = dict.fromkeys(metrics, "m"), lambda trace, context: {}
    return family


@pytest.mark.parametrize(
    ("own", "why"),
    [
        ("peak_torque", r"metric peak_torque: in UNITS of mine, it is a metric of runner\.metrics\.effort; rename it"),
        ("peak_torque_q1", "it contains 'peak_torque', a metric of runner"),
        ("macro_rms_tracking_error_period", "contains 'rms_tracking_error_period', a metric of runner"),
        ("gap", "it is a metric of theirs; rename it"),
        ("largest_gap", "contains 'gap', a metric of theirs"),
    ],
)
def test_a_metric_with_the_name_of_another_family_is_rejected(monkeypatch, own, why):
    families = [_family("mine", own), _family("theirs", "gap", "gap_wide")]
    monkeypatch.setattr(metric_units.METRICS, "added", lambda: families)
    with pytest.raises(ConfigError, match=why):
        metric_units.added_families()


def test_metrics_of_other_names_are_accepted_and_belong_to_their_family(monkeypatch):
    mine = _family("mine", "own", "own_wide", "torque")
    monkeypatch.setattr(metric_units.METRICS, "added", lambda: [mine, mine])  # named and installed
    assert metric_units.added_families() == [mine, mine]
    assert metric_units.owner_of("mini_own_wide_q1") is mine
    assert metric_units.owner_of("peak_torque").__name__ == "runner.metrics.effort"
    assert metric_units.owner_of("speed") is None
