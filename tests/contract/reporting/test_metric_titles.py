"""Titles of metrics: every metric has its own, with stage, axis and joint."""

import sys

import pytest

from runner.metrics import summary
from runner.plugins import metric_units
from runner.reporting.metric_titles import TITLES, metric_label, title


def test_every_metric_of_the_runner_has_a_title_and_no_other():
    assert set(TITLES) == {name for family in summary._FAMILIES for name in family.UNITS}


def test_no_two_metrics_have_one_title():
    assert len(set(TITLES.values())) == len(TITLES)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("max_tracking_error", "largest tracking error"),
        ("max_tracking_error_x", "largest tracking error, x"),
        ("max_axis_error", "largest tracking error on one axis"),
        ("saturation_fraction_q12", "share of ticks at a torque limit, joint 12"),
        ("macro_settling_time", "Macro: settling time"),
        ("macro_max_tracking_error_z", "Macro: largest tracking error, z"),
        ("path_length", "path length"),
        ("controller.gain", "controller.gain"),
    ],
)
def test_a_title_tells_stage_axis_and_joint(name, text):
    assert title(name) == text


def test_a_label_carries_the_unit():
    assert metric_label("control_effort", "N^2 m^2 s") == "control effort (N² m² s)"


@pytest.mark.parametrize(("titles", "text"), [('{"way_q": "way of the tip"}', "way of the tip, y"), ("7", "way q, y")])
def test_a_family_from_outside_may_have_titles_of_its_own(titles, text, tmp_path, monkeypatch):
    module = tmp_path / "family.py"
    module.write_text(
        f"UNITS = {{'way_q': 'm'}}\nTITLES = {titles}\n\n\ndef evaluate(trace, context):\n    return {{}}\n"
    )
    monkeypatch.setattr(metric_units.METRICS, "added", lambda: [_executed(module)])
    assert title("way_q_y") == text


def _executed(path):
    module = type(sys)("family")
    exec(path.read_text(), module.__dict__)
    return module
