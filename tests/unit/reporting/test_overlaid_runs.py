"""Curves of several runs: medians and bands over the cells of a level, panels of noisy curves, captions."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.reporting import overlaid_runs
from runner.reporting.document import Playback
from runner.reporting.overlaid_runs import Level, overlaid

T = np.linspace(0.0, 1.0, 201)


def run(error, t=T, joints=("q1",), torque=0.0, status="ok"):
    """Return a run as the curves read it: a tip error along x, and the torque of each joint."""
    values = np.stack([error * np.ones(len(t)), np.zeros(len(t)), np.zeros(len(t))], axis=1)
    return SimpleNamespace(
        t=t,
        status=status,
        vector=lambda name: values,
        joints=lambda name: np.full((len(t), len(joints)), torque),
        provenance={"joints": list(joints), "commit": "", "command": "runner -m ..."},
        units={f"tau{place + 1}": "N m" for place in range(len(joints))},
    )


@pytest.fixture(autouse=True)
def without_bodies(monkeypatch):
    """Motions need a model of the arm, which these runs have not."""
    monkeypatch.setattr(
        overlaid_runs, "playback", lambda run, caption, has_still: Playback(caption, T, [], np.zeros((2, 3)), None, "")
    )


def test_the_cells_of_a_level_are_a_median_with_a_band():
    """Fault 8: three noisy curves of one law upon another."""
    runs = [run(error) for error in np.arange(11.0)]
    curves, motion = overlaid(
        [Level("a", runs, 3), Level("b", [run(5.0)], 1)], " 12 of 20 cells: noise=1.", "a at seed=0"
    )
    banded, single = curves.panels[0].series
    assert (banded.low[0], banded.y[0], banded.high[0]) == pytest.approx((1.0, 5.0, 9.0))
    assert (banded.color, single.color, single.low) == (3, 1, None)
    assert (banded.level, single.level) == (True, True)
    assert "repetition 0, the one that is stored. 12 of 20 cells: noise=1." in curves.caption
    assert "A curve is the median over 1 to 11 cells, shaded from their 10 % to their 90 % quantile." in curves.caption
    assert motion.caption == "The motions of repetition 0: a at seed=0. The still picture shows a."
    assert (motion.look, [other.look for other in motion.others]) == (3, [1])


def test_runs_of_other_lengths_and_periods_are_read_at_the_times_of_the_longest():
    short = run(2.0, np.linspace(0.0, 0.5, 11))
    (curve,) = overlaid([Level("a", [run(1.0), short], 0)])[0].panels[0].series
    assert np.array_equal(curve.x, T)
    assert (curve.y[0], curve.y[-1]) == (1.5, 1.0)


@pytest.mark.parametrize(("noise", "panels"), [(0.0, 2), (1.0, 3)])
def test_noisy_curves_have_a_panel_each_with_one_range(noise, panels):
    scatter = np.abs(1.0 + noise * np.random.default_rng(0).normal(size=(2, len(T))))
    curves, _ = overlaid([Level("a", [run(scatter[0])], 0), Level("b", [run(3.0 * scatter[1])], 1)])
    assert len(curves.panels) == panels
    assert [len(panel.series) for panel in curves.panels] == ([2, 1, 1] if noise else [2, 2])
    if noise:
        _, *parted = curves.panels
        assert [panel.title for panel in curves.panels] == ["Torque of q1", "Tip error, a", "Tip error, b"]
        assert parted[0].y_range == parted[1].y_range
        assert [panel.has_legend for panel in curves.panels] == [True, False, False]


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_a_diverging_run_does_not_flatten_the_others(noise):
    scatter = np.abs(1.0 + noise * np.random.default_rng(0).normal(size=(2, len(T))) + T)
    diverging = scatter[1] * np.exp(60.0 * T)
    failed = Level("b", [run(diverging, torque=1e20, status="failed")], 1)
    curves, _ = overlaid([Level("a", [run(scatter[0], torque=1.0 + T[:, None])], 0), failed])
    for panel in curves.panels:
        highest = 2.0 if panel.title.startswith("Torque") else scatter[0].max()
        assert highest < panel.y_range[1] < 1.1 * highest
    assert curves.caption.endswith("A curve that leaves the axes diverges.")
    both = [Level(name, [run(diverging, status="failed")], place) for place, name in enumerate("ab")]
    assert "leaves the axes" not in overlaid(both)[0].caption


def test_many_noisy_levels_stay_in_the_same_axes():
    noisy = np.abs(np.random.default_rng(0).normal(size=len(T)))
    curves, _ = overlaid([Level(name, [run(noisy)], place) for place, name in enumerate("abcd")])
    assert [len(panel.series) for panel in curves.panels] == [4, 4]
