"""One figure for both presets: what is drawn and said follows the runs, which are made up here."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from runner.reporting.published_claims import load_claims
from runner.reporting.words import PRESET
from runner.store import Run
from runner.studies.thesis import figures
from runner.studies.thesis.compared import APART, Compared, parting, step_of_both

CLAIMS = [claim for claim in load_claims("thesis") if claim.experiment == "thesis/figure_3_5"]


def metric(median, unit="m"):
    return {"unit": unit, "median": median, "min": median, "max": median, "values": [median]}


def run(error=1.0, ticks=400, settling=1.5, rest=0.008, plant="bullet", caveats=()):
    t = np.linspace(0.0, 4.0, ticks + 1)
    decaying = {f"error_{axis}": error * np.exp(-3.0 * t) for axis in "xyz"}
    tips = {f"tip_{axis}": 1.0 - error * np.exp(-3.0 * t) for axis in "xyz"}
    made = Run(
        Path("run"),
        {"plant": {"kind": plant}, "robot": {"settling_band": 0.02}},
        {
            "status": "ok",
            "repetitions": 1,
            "metrics": {
                "settling_time": metric(settling, "s"),
                "steady_state_error": metric(rest),
                "max_axis_error": metric(error),
                "saturation_fraction": metric(0.3, "1"),
            },
            "failure": None,
            "caveats": [{"rule": rule} for rule in caveats],
            "provenance": {"stages": ["arm"], "joints": ["q1"], "plant_step": 1e-3},
        },
    )
    chatter = 50.0 * np.where(np.arange(ticks + 1) % 2, 1.0, -1.0)
    made.__dict__["_frame"] = pd.DataFrame({"t": t, "tau1": chatter} | decaying | tips)
    return made


def both(first, second):
    return dict(zip(PRESET.values(), (first, second), strict=True))


@pytest.mark.parametrize(
    ("rest", "closer", "alike"),
    [(0.0004, True, False), (0.0079, False, True), (0.08, False, False), (None, False, False)],
)
def test_a_caption_has_the_conditions_of_its_words(rest, closer, alike):
    runs = {"figure_3_5/as_reported": run(), "figure_3_5/full_equations": run(rest=rest)}
    ratio = figures.ratio(runs, "3.5", "steady_state_error")
    assert all(each.holds for each in figures.differs(ratio)) == closer
    assert all(each.holds for each in figures.alike(ratio)) == alike
    shown = figures.both(runs, "3.5", "steady_state_error")
    assert shown == [
        "no value" if rest is None else runs["figure_3_5/full_equations"].metrics["steady_state_error"].text,
        "8 mm",
    ]


@pytest.mark.parametrize(("ratio", "rows"), [(APART / 2.0, 1), (2.0 * APART, 2)])
def test_presets_share_axes_up_to_a_factor(ratio, rows):
    figure = Compared(both(run(1.0), run(1.0 / ratio)))
    panels = figure.errors("error", "Tip error")
    assert len(panels) == 3 * rows
    drawn = [[series.name for series in panel.series if series.x.size] for panel in panels[::3]]
    assert drawn == ([[*PRESET.values()]] if rows == 1 else [[words] for words in PRESET.values()])
    assert ("differ by a factor of 40" in figure.scales()) == (rows == 2)


def test_printed_values_are_drawn_where_they_can_be_seen():
    figure = Compared(both(run(), run()), CLAIMS)
    labels = [series.label for series in figure.errors("error", "Tip error")[0].series]
    assert labels == ["", "", "printed 1.4 s"]
    shown = figure.enlarged()[0]
    (upper, lower) = (series for series in shown.series if not series.name)
    assert (upper.label, lower.label) == ("printed 0 to 9 mm", "")
    assert (set(upper.y), set(lower.y)) == ({0.009}, {-0.009})
    assert shown.y_range[1] > 0.009
    assert Compared(both(run(), run())).enlarged() == []


def test_long_curves_are_envelopes_and_the_last_ticks_are_shown_as_they_are():
    figure = Compared(both(run(ticks=4000), run(ticks=4000)))
    band = figure.torques([1])[0].series[0]
    assert band.x.size < 500
    assert (band.low.min(), band.high.max()) == (-50.0, 50.0)
    ticks = figure.ticks([1])[0].series[0]
    assert ticks.low is None
    assert ticks.x[-1] - ticks.x[0] == pytest.approx(0.05)
    assert figure.torques([1])[0].title == "Joint 1: torque"
    assert Compared(both(run(), run())).torques([1])[0].series[0].low is None
    assert [Compared(both(run(caveats=found), run())).chatters() for found in ((), ("chatter",))] == [False, True]


def held(parted=None, share=0.02, settling=1.4):
    """What is stored of a run that was compared with Runge-Kutta."""
    value = {"value": settling, "difference": None, "share": None if parted else share}
    return {
        "plant": "rk4", "step": 0.01, "largest": 0.5, "at": 0.9, "end": 1e-6, "parted": parted,
        "metrics": {"settling_time": value},
    }  # fmt: skip


def compared(error, **of_run):
    made = run(1.0, **of_run)
    made.record["plant_error"] = error
    return made


def test_what_the_step_is_worth_is_told_of_both_presets():
    named = both(compared(held()), compared(held(share=0.3)))
    text = step_of_both(named, ["settling_time"])
    assert text == (
        "PyBullet's step of 1 ms is worth 2 % (as the thesis ran it) and 30 % (with its full equations) of the "
        "settling time."
    )
    assert parting(named, {"settling_time": 8}) == []


def test_motions_that_part_are_told_with_what_became_of_them():
    named = both(compared(held()), compared(held(parted=0.4), settling=1.63))
    assert step_of_both(named, ["settling_time"]).endswith("is worth 2 % (as the thesis ran it) of the settling time.")
    told, why = parting(named, {"settling_time": 8})
    assert told.startswith(
        "With its full equations: some torque is at its limit for 30 % of the ticks; Runge-Kutta, with the same noise, "
        "goes another way from 0.4 s on, 0.5 m away at 0.9 s, and"
    )
    assert "settles after 1.4 s, outside the 1.63 to 1.63 s of PyBullet's 1 repetitions" in told
    assert told.endswith("claim 8 would read matches in place of larger than printed.")
    assert "PyBullet against Runge-Kutta" in why
    assert (
        step_of_both(named, ["overshoot"])
        == "PyBullet's step of 1 ms moves the tip by 0.5 m (as the thesis ran it) at most."
    )
    apart = both(compared(held(parted=0.4)), compared(held(parted=0.4)))
    assert step_of_both(apart, ["settling_time"]) == ""


def test_a_run_that_was_not_held_against_runge_kutta_is_told_with_the_way_to_it():
    text = step_of_both(both(run(), run()), ["settling_time"])
    assert text.count("plant_error=true measures it") == 2
