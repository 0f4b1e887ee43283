"""Figures of stored runs against their traces, and the command behind each."""

from dataclasses import replace

import numpy as np
import pyarrow
import pytest
from fixtures.stored import RUNS

from runner.reporting.figures import (
    desired_motion,
    origin,
    playback,
    torque_and_error,
)
from runner.sweeps.job import run


@pytest.fixture
def stored(runs):
    return runs["quintic"]


def test_an_origin_names_the_command_that_makes_the_run(stored):
    source = origin(stored, "figure 3.5")
    assert source.number == "figure 3.5"
    assert source.command == f"runner {' '.join(RUNS['quintic'])}"
    assert source.commit == "" or len(source.commit.removesuffix("+changes")) == 12


def test_the_model_is_that_of_the_stored_urdf(stored):
    q = stored.joints()
    assert np.allclose(stored.model.tip_positions(q), stored.vector("tip"), atol=1e-12)


def test_joint_signals_leave_out_signals_with_the_same_beginning(stored):
    assert stored.joints().shape == (201, 3)
    assert np.array_equal(stored.joints("dq")[:, 2], stored.trace()["dq3"])


def test_torque_and_error_are_the_trace(stored):
    figure = torque_and_error(stored, "caption")
    torque, error = figure.panels
    assert [series.name for series in torque.series] == ["q1", "q2", "q3"]
    assert [series.name for series in error.series] == ["x", "y", "z"]
    assert (torque.y_label, error.y_label) == ("torque (N m)", "tip error (m)")
    assert np.array_equal(torque.series[1].y, stored.trace()["tau2"])
    assert np.array_equal(error.series[2].y, stored.trace()["desired_z"] - stored.trace()["tip_z"])


def test_desired_motion_ends_with_the_motion_and_keeps_the_colour_of_its_axis(stored):
    figure = desired_motion(stored, "caption", "figure 3.6", ("y",))
    assert [panel.y_label for panel in figure.panels] == [
        "desired position (m)", "desired velocity (m/s)", "desired acceleration (m/s²)",
    ]  # fmt: skip
    for panel in figure.panels:
        (series,) = panel.series
        assert series.x[-1] == pytest.approx(1.0)
        assert (series.name, series.color) == ("y", 1)
    speed = np.abs(figure.panels[1].series[0].y).max()
    assert speed == pytest.approx(1.875 * 1.7571, rel=1e-4)


def test_a_shaped_motion_is_shown_to_its_end(tmp_path):
    shaper = ("input_shaper=zv", "input_shaper.frequency=2.5", "duration=1.3")
    shaped = run(*RUNS["quintic"], *shaper, f"outputs={tmp_path}")
    speed = desired_motion(shaped, "caption").panels[1].series[0]
    assert speed.x[-1] == pytest.approx(1.3)
    assert abs(speed.y[np.searchsorted(speed.x, 1.1)]) > 0.01  # later than trajectory.duration


def test_a_playback_thins_the_frames_but_not_the_path(stored):
    shown = playback(stored, "caption", frames=30)
    assert len(shown.times) == 30
    assert shown.times[[0, -1]].tolist() == [0.0, 2.0]
    assert len(shown.path) == 201
    assert [body.positions.shape for body in shown.bodies] == [(30, 3)] * len(shown.bodies)
    tip = next(body for body in shown.bodies if body.name == "tip")
    assert np.allclose(tip.positions[-1], shown.path[-1], atol=1e-9)


def test_a_playback_of_a_diverged_run_leaves_out_what_is_no_number(runs):
    failed = replace(runs["failed"])
    assert failed.status == "failed"
    trace = failed.trace()
    trace.loc[len(trace) - 1, "q1"] = np.nan
    failed.__dict__["_table"] = pyarrow.Table.from_pandas(trace)
    shown = playback(failed, "caption")
    assert np.isfinite(shown.path).all()
    assert np.isfinite([body.positions for body in shown.bodies]).all()
