"""`runner figures`: the files of figures of runs and sweeps, and what is refused."""

import pytest


def names(folder):
    return {path.name for path in folder.iterdir()}


def test_the_figures_of_a_run_lie_beside_its_report(cli, copy_run):
    made = copy_run("pairs")
    ending = cli("figures", made)
    assert ending.code == 0
    assert ending.folder.name == "figures"
    assert ending.folder.parent == cli("report", made, "--format", "html").folder
    listed = ending.out.splitlines()[:-1]
    assert names(ending.folder) >= {f"{name}.{kind}" for name in listed for kind in ("svg", "pdf", "csv", "txt")}
    assert (listed[0], listed[-1]) == ("torque-and-tip-error-over-time", "motion")
    caption = (ending.folder / f"{listed[0]}.txt").read_text()
    assert caption.endswith("repetition 0. (a) Torque of each joint; (b) Tip position error.\n")


def test_a_figure_of_a_sweep_is_made_again_in_the_width_asked_for(cli, copy_sweep, tmp_path):
    swept = copy_sweep("goal", "noise")
    ending = cli("figures", swept, "--width", "double", "--output", tmp_path / "papers", "--only", "share")
    assert ending.folder == tmp_path / "papers"
    (name,) = ending.out.splitlines()[:-1]
    assert names(tmp_path / "papers") == {f"{name}.{kind}" for kind in ("svg", "pdf", "csv", "txt")}
    before = {path.name: path.read_bytes() for path in (tmp_path / "papers").iterdir()}
    cli("figures", swept, "--width", "180mm", "--output", tmp_path / "papers", "--only", name)
    assert {path.name: path.read_bytes() for path in (tmp_path / "papers").iterdir()} == before


def test_a_failed_run_is_drawn_up_to_its_failure_and_told(cli, copy_run):
    ending = cli("figures", copy_run("failed"))
    assert ending.code == 0
    assert "runner: the run failed in repetition 0 at t = " in ending.err
    assert "its figures show repetition 0, up to " in ending.err


def test_a_failed_run_without_a_trace_has_no_figures(cli, copy_run):
    made = copy_run("failed")
    (made / "trace.parquet").unlink()
    ending = cli("figures", made)
    assert ending.code == 2
    assert "the run failed in repetition 0 at t = " in ending.err
    assert "it has no trace to draw" in ending.err
    assert len(ending.err.splitlines()) == 1


def test_a_study_that_was_not_made_is_told(cli):
    ending = cli("figures", "xarm7")
    assert ending.code == 2
    assert "no report on xarm7 in outputs; `runner reproduce xarm7 --output outputs` makes it" in ending.err


@pytest.mark.slow
def test_a_study_of_which_runs_are_missing_is_told_and_none_is_made(cli, tmp_path):
    folder = tmp_path / "o" / "reports" / "xarm7"
    folder.mkdir(parents=True)
    ending = cli("figures", folder)
    assert ending.code == 2
    assert f"runs of xarm7 are not stored in {tmp_path / 'o'} as they are made today; `runner repro" in ending.err
    assert not (tmp_path / "o" / "runs").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nowhere",), "nowhere: no such folder"),
        ((), "the following arguments are required: DIR"),
    ],
)
def test_bad_input_is_one_line(cli, arguments, message):
    ending = cli("figures", *arguments)
    assert ending.code == 2
    assert message in ending.err
    assert len(ending.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("width", "message"),
    [
        ("triple", "--width: not a width ('triple'). Allowed: single (88 mm), double (180 mm), or 60 to 400 in mm."),
        ("5", "--width: not a width ('5'). Allowed: single"),
    ],
)
def test_a_width_that_is_none_is_one_line(cli, copy_run, width, message):
    ending = cli("figures", copy_run("goal"), "--width", width)
    assert (ending.code, ending.err.count("\n")) == (2, 1)
    assert message in ending.err


def test_an_unknown_figure_is_told_with_those_that_there_are(cli, copy_run):
    ending = cli("figures", copy_run("goal"), "--only", "figure-9")
    assert ending.code == 2
    assert "--only: no figure 'figure-9'" in ending.err
    assert "torque-and-tip-error-over-time" in ending.err
