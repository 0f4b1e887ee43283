"""A run object for users: a short string, a whole page, and access to every repetition."""

import re

import numpy as np
import pytest

import runner
from runner.api.page import code, heading, line, listed, picture, table
from runner.base.machine import Machine

ONE_ARM = """\
# @package _global_
robot:
  name: own
  urdf: arm.urdf
  tip: tip
  home: [0.0, 0.3, -0.6]
  goal: [0.4, 1.1, 0.9]
"""
WORDS = ("robot=macro", "trajectory=quintic", "noise=thesis", "duration=0.1", "repetitions=3")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return runner.run(*WORDS, outputs=tmp_path_factory.mktemp("outputs"))


def test_metrics_are_typed_and_named(run):
    torque = run.metrics["peak_torque"]
    stored = run.record["metrics"]["peak_torque"]
    assert (torque.unit, torque.median, torque.min, torque.max) == (
        "N m",
        *(stored[k] for k in ("median", "min", "max")),
    )
    assert set(run.metrics) == set(run.record["metrics"])
    assert "peak" not in run.metrics
    assert run.metrics.get("peak") is None
    with pytest.raises(runner.RunnerError, match=r"^unknown metric 'peak_torqe'\. .* Did you mean 'peak_torque'\?"):
        _ = run.metrics["peak_torqe"]


def test_a_spec_tells_how_probable_it_is_that_it_is_broken(run):
    assert run.spec is None
    bound = {"spec.metrics.peak_torque.max": "1N m"}
    judged = runner.run(*WORDS, outputs=run.folder.parents[1], **bound)
    assert judged.folder == run.folder
    assert (judged.spec.failing.kept, judged.spec.failing.of, judged.spec.failing.high) == (3, 3, 1.0)
    assert judged.spec.bounds[0].failing == judged.spec.failing


def test_the_frame_of_metrics(run):
    frame = run.to_frame()
    assert list(frame.columns) == ["unit", "median", "min", "max", "n"]
    assert list(frame.index) == list(run.metrics)
    assert frame.loc["peak_torque", "median"] == run.metrics["peak_torque"].median
    assert frame.loc["steady_state_error", "n"] == 0  # the motion continues
    assert np.isnan(frame.loc["steady_state_error", "median"])


def test_as_text_it_is_a_few_lines(run):
    lines = repr(run).splitlines()
    assert lines[0].startswith("Run of macro, operational_space, quintic, ")
    assert lines[0].endswith(": ok, 3 repetitions")
    assert lines[1].startswith("  largest tracking error ")
    assert lines[-1] == f"  {run.folder}"
    assert len(lines) <= 4


def test_as_a_page_it_has_metrics_with_units_caveats_and_a_picture(run):
    page = run._repr_html_()
    assert re.search(r"largest tracking error</td><td[^>]*>[\d.]+ (mm|µm)", page)
    for caveat in run.caveats:
        assert caveat["rule"] in page
    assert page.count("data:image/svg+xml;base64,") == 1
    assert str(run.folder) in page


def test_nothing_from_outside_is_markup_on_a_page():
    evil = "<script>alert(1)</script>&\x1b"
    pages = [
        heading(evil, evil),
        line(evil),
        table([evil], [[evil]]),
        listed(evil, [evil]),
        code(evil),
        picture("<svg/>", evil),
    ]
    for page in pages:
        assert "<script" not in page
        assert "\x1b" not in page
        assert "&lt;script&gt;" in page
    assert '"' not in picture("<svg/>", '"').partition('alt="')[2].partition('" style')[0]


def test_the_first_trace_is_the_stored_one_and_none_can_spoil_it(run):
    frame = run.trace()
    assert len(frame) == 11
    assert frame.equals(runner.store.open_run(run.folder).trace())
    frame["q1"] = 0.0
    assert not run.trace().equals(frame)
    assert run.units["tau1"] == "N m"


@pytest.mark.parametrize("more", [(), ("mismatch.mass=1.2", "mismatch.spread=0.1"), ("plant=rk4",)], ids=str)
def test_any_repetition_is_simulated_again(more, tmp_path):
    run = runner.run(*WORDS, *more, outputs=tmp_path)
    frames = [run.trace(repetition) for repetition in range(3)]
    assert list(frames[2].columns) == list(frames[0].columns)
    for frame, largest in zip(frames, run.metrics["max_axis_error"].values, strict=True):
        error = frame[["error_x", "error_y", "error_z"]].to_numpy()
        assert np.abs(error).max() == largest
    assert not frames[1].equals(frames[2])


def test_a_first_repetition_that_was_not_kept_is_simulated_again(tmp_path):
    words = [*WORDS, f"outputs={tmp_path}", "sweep.trace=never"]
    cell = runner.sweep(*words, seed=[0, 1], workers=0).run(seed=1)
    alone = runner.run(*WORDS, seed=1, outputs=tmp_path / "others")
    assert not cell.folder.exists()
    assert cell.trace().equals(alone.trace())
    assert "<img" not in cell._repr_html_()


@pytest.mark.parametrize("repetition", [-1, 3])
def test_no_other_repetitions(run, repetition):
    with pytest.raises(runner.RunnerError, match=rf"has no repetition {repetition}\. Allowed: 0 to 2"):
        run.trace(repetition)


def test_changed_code_gives_no_other_repetition(run, monkeypatch):
    monkeypatch.setattr("runner.store.identity.physics_digest", lambda: "other")
    assert len(run.trace()) == 11
    with pytest.raises(runner.RunnerError, match="the code has changed since the run"):
        run.trace(1)


def test_a_repetition_with_other_metrics_is_refused(run):
    metrics = {name: dict(metric) for name, metric in run.record["metrics"].items()}
    metrics["energy"]["values"] = [0.0, 0.0, 0.0]
    other = runner.Run(run.folder, run.config, {**run.record, "metrics": metrics})
    with pytest.raises(runner.RunnerError, match=r"simulated again, differs: energy is .*, stored is 0\.0"):
        other.trace(1)


def rounded(run, share, **provenance):
    """Return a run whose stored energy differs by a share, and parts of its provenance."""
    metrics = {name: dict(metric) for name, metric in run.record["metrics"].items()}
    metrics["energy"]["values"] = [value * (1 + share) for value in metrics["energy"]["values"]]
    record = {**run.record, "metrics": metrics, "provenance": {**run.provenance, **provenance}}
    return runner.Run(run.folder, run.config, record)


OTHERS = [{"machine": Machine("Alpha", "Linux").record()}, {"machine": "Alpha, Linux x86_64"}, {"versions": {}}]


@pytest.mark.parametrize("provenance", OTHERS, ids=str)
def test_a_run_of_another_machine_is_accepted_up_to_rounding(run, provenance):
    other = rounded(run, 1e-9, **provenance)
    with pytest.warns(RuntimeWarning, match="in the last digits of 1 metrics: its machine or library") as warned:
        assert other.trace(1).equals(run.trace(1))
    assert warned[0].filename == __file__
    with pytest.raises(runner.RunnerError, match="another machine or library version rounds in another way"):
        rounded(run, 1e-5, **provenance).trace(1)


def test_a_run_of_this_machine_must_have_the_same_bits(run):
    with pytest.raises(runner.RunnerError, match="so it is not reproducible"):
        rounded(run, 1e-9).trace(1)


def test_a_robot_whose_file_has_changed_is_told(tmp_path, monkeypatch, macro_urdf):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine/robot").mkdir(parents=True)
    (tmp_path / "mine/arm.urdf").write_text(macro_urdf)
    (tmp_path / "mine/robot/own.yaml").write_text(ONE_ARM)
    run = runner.run(
        robot="own", trajectory="quintic", duration=0.05, repetitions=2, noise="thesis", config_dirs="mine"
    )
    assert len(run.trace(1)) == len(run.trace(0))
    (tmp_path / "mine/arm.urdf").write_text(macro_urdf.replace('<mass value="', '<mass value="1'))
    with pytest.raises(runner.RunnerError, match="the file of its robot has changed"):
        run.trace(1)


@pytest.mark.parametrize("signal", ["error", "tip", "torque", "position", "velocity", "desired_velocity"])
def test_signals_are_drawn(run, signal):
    figure = run.plot(signal)
    (axes,) = figure.axes
    assert len(axes.lines) == (6 if signal == "tip" else 3)
    assert axes.get_xlabel().startswith("time (")
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_another_repetition_is_drawn(run):
    first, third = (run.plot("error", repetition=repetition).axes[0].lines[0].get_ydata() for repetition in (0, 2))
    assert not np.array_equal(first, third)


def test_an_unknown_signal_tells_the_known(run):
    with pytest.raises(
        runner.RunnerError, match=r"unknown signal 'eror'\. .* torque, tip, error.* Did you mean 'error'\?"
    ):
        run.plot("eror")


def test_a_failed_run_says_why(tmp_path):
    run = runner.run(*WORDS, "controller.natural_frequency=5000", "duration=1.0", outputs=tmp_path)
    assert run.status == "failed"
    assert run.failure.startswith("failed in repetition 0 at t = ")
    assert run.failure in repr(run)
    assert "failed in repetition 0" in run._repr_html_()
    assert len(run.to_frame()) == len(run.metrics)
