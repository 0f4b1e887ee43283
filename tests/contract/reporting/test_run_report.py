"""The report on runs: one that finished, one that failed, and several of them."""

from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from fixtures.stored import RUNS
from support.engines import ASKED

from runner.base.quantities import quantity, with_powers
from runner.reporting import figures, outline
from runner.reporting.comparison.runs import runs_document
from runner.reporting.document import Code, Curves, Notice, Playback, Provenance, Table, Text
from runner.reporting.mathml import faulty
from runner.reporting.metric_titles import title
from runner.reporting.nearest_limit import nearest_to_limit
from runner.reporting.render import write_report
from runner.reporting.run_report import provenance, run_document
from runner.reporting.words import PLANT
from runner.sweeps.job import run


@pytest.fixture
def finished(runs):
    return runs["quintic"]


@pytest.fixture
def diverged(runs):
    return runs["failed"]


def blocks_of(document, kind):
    return [block for block in outline.blocks(document) if isinstance(block, kind)]


@pytest.mark.parametrize("name", ["failed", "stages", "flexible", "rk4"])
def test_the_report_is_as_recorded(runs, name, as_recorded):
    diverged = (r"-: Curves", r"-: Playback") if name == "failed" else ()
    as_recorded("reports", name, run_document(runs[name]), diverged)


def test_the_report_on_two_runs_is_as_recorded(runs, as_recorded):
    as_recorded("reports", "two engines", runs_document([runs["rk4"], runs["mujoco"]]))


def test_runs_beyond_those_that_can_be_told_apart_are_not_drawn(runs):
    document = runs_document([runs["goal"], runs["other seed"]] * 5)
    assert "2 runs are not drawn" in [notice.title for notice in blocks_of(document, Notice)]


def test_a_finished_run_is_told_whole(finished):
    document = run_document(finished)
    assert document.title.startswith("Macro, operational space, quintic, ")
    assert document.abstract == "2 repetitions, all of them finished; smallest to largest in brackets."
    assert document.key_numbers[0][0] == "largest tracking error"
    assert [type(block) for block in outline.blocks(document)] == [
        Notice,
        Curves,
        Curves,
        Playback,
        Table,
        Text,
        Table,
        Table,
        Code,
        Provenance,
    ]
    metrics, changed, config = blocks_of(document, Table)
    assert [row[1] for row in metrics.rows] == list(finished.metrics)
    assert metrics.rows[0][0] == title(metrics.rows[0][1])
    assert metrics.caption == "Metrics over 2 repetitions."
    assert ["controller.natural_frequency", "30.0"] in [list(row) for row in config.rows]
    assert ["trajectory.duration", "1.0", "3.0"] in [list(row) for row in changed.rows]
    assert "outputs" not in [row[0] for row in config.rows]
    (file,) = blocks_of(document, Code)
    assert yaml.safe_load(file.text) == {key: value for key, value in finished.config.items() if key != "outputs"}
    (block,) = blocks_of(document, Provenance)
    rows = dict(block.rows)
    assert rows["plant"] == f"{PLANT[ASKED.removeprefix('plant=')]} in steps of 1 ms"
    assert rows["seed"] == "0"
    assert rows["command"] == f"runner {' '.join(RUNS['quintic'])}"
    assert rows["run"] == finished.hash


def test_a_shaper_and_a_notch_stand_below_the_title(tmp_path):
    shaped = ("input_shaper=zvd", "input_shaper.frequency=3", "notch=torques", "duration=0.05", f"outputs={tmp_path}")
    document = run_document(run("robot=macro", "trajectory=quintic", *shaped))
    assert document.subtitle == "no torque limits, noise none, input shaper ZVD, a notch in the torques"


@pytest.mark.parametrize(
    ("noise", "named"),
    [
        (("noise.position=1mrad",), "no torque limits, noise.position=0.001"),
        (("noise=thesis",), "no torque limits, noise thesis"),
        (("noise=thesis", "noise.position=2mrad"), "no torque limits, noise thesis, noise.position=0.002"),
        (("torque_limits.max=20",), "noise none, torque_limits.max=20.0"),
        (("torque_limits=thesis", "torque_limits.max=20"), "torque limits thesis, noise none, torque_limits.max=20.0"),
    ],
)
def test_noise_that_was_set_is_not_called_none(tmp_path, noise, named):
    made = run("robot=macro", "trajectory=quintic", *noise, "duration=0.05", f"outputs={tmp_path}")
    assert run_document(made).subtitle == named


def test_steps_of_a_plant_stand_together_and_seeds_in_a_row_are_a_range(finished):
    def with_seed(seed, step):
        config, record = finished.config, {**finished.provenance, "seed": seed, "plant_step": step}
        return SimpleNamespace(config=config, provenance=record, hash=str(seed))

    rows = dict(
        provenance([with_seed(seed, step) for seed, step in ((2, 1e-3), (0, 2.5e-4), (1, 1e-3), (7, 1e-3))]).rows
    )
    assert rows["seed"] == "0 to 2, 7"
    assert rows["plant"] == f"{PLANT[ASKED.removeprefix('plant=')]} in steps of 0.25 ms, 1 ms"


def test_a_failed_run_shows_its_last_moments_on_axes_that_its_divergence_leaves(diverged, monkeypatch):
    time = diverged.failure_record["time"]
    monkeypatch.setattr(figures, "_LAST_ROWS", 4)
    last, whole = [block for block in blocks_of(run_document(diverged), Curves) if "repetition 0" in block.caption]
    assert whole.panels[0].x_range == (0.0, time)
    for panel, same in zip(last.panels, whole.panels, strict=True):
        start, end = panel.x_range
        assert end == time
        assert start <= max(0.0, time - 0.02)
        shown = np.abs(np.concatenate([each.y[each.x >= start] for each in same.series]))
        assert panel.y_range == (-panel.y_range[1], pytest.approx(4.0 * np.median(shown[shown > 0.0])))
    torque = np.concatenate([each.y for each in last.panels[0].series])
    assert np.nanmax(np.abs(torque)) > last.panels[0].y_range[1]


def test_a_run_no_longer_than_its_last_moments_is_drawn_once(diverged):
    (whole,) = [block for block in blocks_of(run_document(diverged), Curves) if "repetition 0" in block.caption]
    assert "up to the failure, repetition 0. A curve that leaves the axes diverges." in whole.caption


def test_a_failed_run_says_when_and_where(diverged):
    document = run_document(diverged)
    assert document.abstract.startswith(f"The run {with_powers(diverged.failure)}.")
    assert "1e+06" not in document.abstract
    assert "Its velocity loop is unstable: the gain is 1.8 times too large for the period." in document.abstract
    assert "controller.natural_frequency below 16.7 or controller.period below 0.0333." in document.abstract
    assert not [block for block in blocks_of(document, Curves) if "Desired motion" in block.caption]
    (notice,) = [block for block in blocks_of(document, Notice) if block.kind == "failure"]
    time, joint = diverged.failure_record["time"], diverged.failure_record["joint"]
    assert 0.0 < time < 4.0
    assert joint in ("q1", "q2", "q3")
    assert f"In repetition 0 at t = {time:.3g} s, joint {joint}: diverged" in notice.text


def test_runs_stand_side_by_side(finished, diverged, tmp_path):
    other = run(*RUNS["quintic"], "seed=1", f"outputs={tmp_path}")
    document = runs_document([finished, other, diverged])
    assert document.abstract.startswith(f"C {with_powers(diverged.failure)}.")
    assert "A and B: not compared in pairs: seed 0 and seed 1 share no noise." in document.abstract
    metrics, differing = blocks_of(document, Table)[:2]
    assert metrics.lines[0] == ["metric", "A", "B", "C"]
    rows = {name: values for name, *values in metrics.rows}
    errors = [quantity(one.metrics["max_tracking_error"].median, "m") for one in (finished, other)]
    assert rows["largest tracking error"] == [*errors, "–"]
    assert ["controller.period", "0.01", "0.01", "0.06"] in [list(row) for row in differing.rows]
    curves = blocks_of(document, Curves)[0]
    assert [panel.title for panel in curves.panels] == ["Tip error", "Torque of q1", "Torque of q2", "Torque of q3"]
    assert all([series.name for series in panel.series] == ["A", "B", "C"] for panel in curves.panels)
    assert document.shown == 1


def test_two_runs_show_their_difference_and_the_answer(tmp_path):
    runs = [run("robot=macro", "noise=thesis", "duration=0.1", "repetitions=6", f"controller.damping_ratio={ratio}",
                f"outputs={tmp_path}") for ratio in (1.0, 0.5)]  # fmt: skip
    document = runs_document(runs)
    assert "A and B differ only in controller.damping_ratio: 1 against 0.5." in document.abstract
    assert ", 6 pairs" in document.abstract
    assert document.title.startswith("Which controller.damping_ratio: 1 (A) or 0.5 (B)?")
    short, medians = blocks_of(document, Table)[:2]
    assert short.lines[0] == ["metric", "A", "B - A", "answer"]
    assert medians.lines[0] == ["metric", "A", "B"]  # the difference has one estimate


def test_the_joint_nearest_to_its_torque_limit_is_told(tmp_path):
    limited = run("robot=macro", "trajectory=quintic", "duration=0.3", "torque_limits.max=[1e3,400,1e3]",
                  f"outputs={tmp_path}")  # fmt: skip
    what, share, when = nearest_to_limit(limited)
    torques = np.abs(limited.joints("tau")[:-1]) / [1e3, 400.0, 1e3]
    row, joint = np.unravel_index(torques.argmax(), torques.shape)
    assert (what, share) == ("nearest to a torque limit", f"q{joint + 1}: {100.0 * torques.max():.2g} %")
    assert when.startswith(f"at {quantity(limited.t[row], 's', 2)}")
    assert run_document(limited).key_numbers[-1] == (what, share, when)
    free = run("robot=macro", "duration=0.05", f"outputs={tmp_path}")
    assert nearest_to_limit(free) is None


def test_every_kind_of_report_is_written_as_html_and_pdf(finished, diverged, tmp_path):
    document = runs_document([finished, diverged])
    assert faulty(document) == []
    html, pdf = write_report(document, tmp_path)
    assert "This run failed" in html.read_text()
    assert pdf.read_bytes().startswith(b"%PDF")
