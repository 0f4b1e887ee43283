"""A published figure under all presets: panels, printed values, envelopes; the runs are invented here."""

from pathlib import Path

import numpy as np
import pyarrow
import pytest

from runner.papers.reporting.published_claims import load_claims
from runner.papers.study.prose.compared import compare
from runner.store import Run

PRESETS = {"as_reported": "fitted", "full_equations": "printed"}
CLAIMS = load_claims("thesis")


def run(error=1.0, ticks=400, staged=False, kind="goal", caveats=(), jumps=1.0):
    t = np.linspace(0.0, 4.0, ticks + 1)
    stages, joints = (["macro", "mini"], ["q1", "mini_q1"]) if staged else (["arm"], ["q1"])
    record = {
        "status": "ok",
        "repetitions": 1,
        "metrics": {"macro_max_axis_error": {"unit": "m", "median": 0.1, "min": 0.1, "max": 0.1, "values": [0.1]}},
        "caveats": [{"rule": rule} for rule in caveats],
        "provenance": {"stages": stages, "joints": joints, "command": "runner", "commit": ""},
    }
    made = Run(Path("run"), {"trajectory": {"kind": kind}}, record)
    chatter = np.where(t <= jumps * t[-1], 50.0, 0.0) * np.where(np.arange(ticks + 1) % 2, 1.0, -1.0)
    errors = {f"{name}_{axis}": error * np.exp(-3.0 * t) for name in ("error", "macro_error") for axis in "xyz"}
    made.__dict__["_table"] = pyarrow.table({"t": t, "tau1": chatter, "tau2": np.sin(t)} | errors)
    return made


def figure(experiment, first, second, until=None):
    runs = {f"{experiment}/{preset}": own for preset, own in zip(PRESETS, (first, second), strict=True)}
    runs["macro_alone/as_reported"] = first
    return compare(runs, PRESETS, CLAIMS, "Finding.\nShown.", experiment, "figure 1", until)


def test_all_presets_are_in_each_panel_and_curves_are_named_at_their_peaks():
    made = figure("figure_3_5", run(), run(0.5))
    assert (made.finding, made.caption) == ("Finding.", "Shown.")
    torque, error, rest = made.panels
    for panel in (torque, error, rest):
        named = [(series.name, series.style) for series in panel.series if series.name]
        assert named == [("fitted", "line"), ("printed", "dashed")]
    assert [series.label for series in error.series if series.label] == ["x", "y", "z"]
    drawn = [series for series in error.series if series.x.size > 10]
    assert [(series.style, series.color) for series in drawn] == [(s, c) for s in ("line", "dashed") for c in range(3)]
    assert [float(series.y[0]) for series in drawn] == [1.0] * 3 + [0.5] * 3


def test_printed_values_are_dotted_where_they_can_be_seen_and_named_in_the_title():
    torque, error, rest = figure("figure_3_5", run(), run()).panels
    assert torque.title == "Torque"
    assert error.title == "Tip error (dotted: printed 1.4 s)"
    (upright,) = (series for series in error.series if series.style == "dotted")
    assert set(upright.x) == {1.4}
    assert rest.title == "Tip error at rest (dotted: printed 0 to 9 mm)"
    levels = [set(series.y) for series in rest.series if series.style == "dotted"]
    assert levels == [{0.009}, {-0.009}]
    assert rest.y_range[1] > 0.009
    far = figure("figure_3_10", run(50.0, kind="quintic"), run(50.0, kind="quintic")).panels
    assert [panel.title for panel in far] == ["Torque", "Tip error"]


@pytest.mark.parametrize("caveats", [(), ("chatter",)])
def test_a_staged_arm_has_a_panel_for_each_stage_and_one_for_the_carrying_end_point(caveats):
    shown = figure("figure_5_13", run(staged=True, kind="quintic", caveats=caveats), run(staged=True, kind="quintic"))
    ticks = ["Mini torque, last 50 ms"] * len(caveats)
    titles = ["Macro torque", "Mini torque", *ticks, "Macro end point, error"]
    assert [panel.title for panel in shown.panels] == [*titles, "Tip error (dotted: compared with 0.1 m)"]
    assert shown.columns == (3 if caveats else 2)
    for panel in shown.panels[2 : 2 + len(caveats)]:
        assert all(np.ptp(series.x) < 0.051 for series in panel.series if series.x.size)


def test_a_curve_that_jumps_now_and_then_becomes_a_band_one_that_always_jumps_its_mean_and_a_smooth_one_a_line():
    torque, error, _ = figure("figure_3_5", run(ticks=4000, jumps=0.2), run(ticks=4000, jumps=0.2)).panels
    jumping = next(series for series in torque.series if series.x.size > 10)
    assert (jumping.low.min(), jumping.high.max()) == (-50.0, 50.0)
    assert torque.title == "Torque"
    bars = figure("figure_3_5", run(ticks=4000), run(ticks=4000)).panels[0]
    assert bars.title == "Torque (means over 20 ms)"
    assert [series.low for series in bars.series] == [None] * len(bars.series)
    assert max(np.median(np.abs(series.y)) for series in bars.series if series.x.size > 10) < 5.0
    smooth = next(series for series in error.series if series.x.size > 10)
    assert smooth.low is None
    assert smooth.x.size < 250
    assert figure("figure_3_5", run(ticks=4000), run(ticks=4000), 0.1).panels[0].series[1].x[-1] <= 0.1
