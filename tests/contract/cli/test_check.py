"""`runner check` of runs and sweeps against baselines: bands, and what is refused."""

import json
import shutil

import numpy as np
import pytest

from runner.store.baselines import shipped_baselines

GOOD = "schema: 1\nmetrics:\n  peak_torque: {min: 0.0, reason: torques have no sign here}\n"
BAD = """\
schema: 1
metrics:
  peak_joint_speed: {min: 1e3, max: 1e4, reason: as if it flew}
  settling_time: {max: 1.0, reason: it should settle}
  max_tracking_error: {max: 1.0, reason: it should follow}
  saturation_fraction: {max: 0.0, reason: there is no limit}
"""


@pytest.fixture
def reference(tmp_path):
    def write(text):
        path = tmp_path / "baseline.yaml"
        path.write_text(text)
        return path

    return write


def test_a_run_inside_its_bands_says_so_in_one_line(cli, copy_run, reference):
    run = copy_run("goal")
    path = reference(GOOD)
    ending = cli("check", run, "--baseline", path)
    assert (ending.code, ending.err) == (0, "")
    assert ending.out == f"good: 1 metrics of 1 run lie in the bands of {path}\n"


def test_what_falls_short_is_a_table_with_reasons(cli, copy_run, reference):
    run = copy_run("goal")
    ending = cli("check", run, "--baseline", reference(BAD))
    assert (ending.code, ending.err) == (1, "")
    head, title, *rows = ending.out.splitlines()
    assert head.startswith(f"{run}: 3 of 4 metrics fall short of ")
    assert title.split() == ["metric", "found", "band", "reason"]
    table = {row.split()[0]: row.split(maxsplit=2)[1:] for row in rows}
    assert table["peak_joint_speed"][1].split("  ") == ["1000 to 10000", "as if it flew"]
    assert table["settling_time"] == ["-", f"{'at most 1':<15}it should settle"]
    assert table["max_tracking_error"][0] == "-"  # a goal has none
    assert "saturation_fraction" not in table


def test_the_median_over_repetitions_is_checked(cli, copy_run, reference):
    run = copy_run("pairs")
    record = json.loads((run / "metrics.json").read_text())
    median = float(np.median(record["metrics"]["peak_joint_speed"]["values"]))
    band = f"schema: 1\nmetrics:\n  peak_joint_speed: {{min: {median}, max: {median}, reason: exactly the median}}\n"
    assert cli("check", run, "--baseline", reference(band)).code == 0


def test_a_failed_run_falls_short(cli, copy_run, reference):
    ending = cli("check", copy_run("failed"), "--baseline", reference(GOOD))
    assert ending.code == 1
    assert "1 of 1 metrics fall short" in ending.out
    assert "  failed in repetition 0 at t = 0.6 s (q1): diverged" in ending.out


def test_a_sweep_is_checked_run_by_run(cli, copy_sweep, reference):
    sweep = copy_sweep("goal", "other seed")
    assert cli("check", sweep, "--baseline", reference(GOOD)).out.startswith("good: 2 metrics of 2 runs lie in ")
    assert cli("check", sweep, "--baseline", reference(BAD)).out.count("fall short") == 2


def test_the_shipped_reference_follows_from_experiment_and_preset(cli):
    run = cli("experiment=thesis/figure_3_10", "preset=as_reported", "repetitions=3").folder
    ending = cli("check", run)
    assert (ending.code, ending.err) == (0, "")
    assert ending.out == "good: 10 metrics of 1 run lie in the bands of thesis/figure_3_10.as_reported\n"


def test_a_changed_controller_falls_short_of_the_shipped_reference(cli):
    overrides = ("repetitions=1", "controller.natural_frequency=20")
    run = cli("experiment=thesis/figure_3_10", "preset=as_reported", *overrides).folder
    ending = cli("check", run)
    assert ending.code == 1
    assert "max_axis_error" in ending.out


def test_without_a_shipped_reference_the_way_out_is_named(cli, copy_run):
    ending = cli("check", copy_run("goal"))
    assert ending.code == 2
    assert "no bundled baseline for a run without an experiment. Give one by --baseline FILE" in ending.err
    assert f"`runner list baselines` prints the {len(shipped_baselines())} bundled ones.\n" in ending.err
    assert len(ending.err) < 400
    run = cli("experiment=thesis/lag", "duration=0.05").folder
    assert "for 'thesis/lag.full_equations'" in cli("check", run).err


def test_a_copied_run_is_checked_elsewhere(cli, copy_run, reference, tmp_path):
    copy = shutil.copytree(copy_run("goal"), tmp_path / "elsewhere" / "copy")
    shutil.rmtree(tmp_path / "outputs")
    assert cli("check", copy, "--baseline", reference(GOOD)).code == 0
    assert cli("compare", copy, copy).code == 0


def test_folders_and_files_that_cannot_be_read(cli, copy_run, reference, tmp_path):
    run = copy_run("goal")
    cases = [
        (("check", tmp_path / "gone"), "no such folder"),
        (("check", tmp_path), "it is not the folder of a stored result"),
        (("check", run, "--baseline", "gone.yaml"), "cannot read the baseline gone.yaml"),
        (("check", run, "--baseline", run), "cannot read the baseline"),
        (("check", run, "--baseline", reference("schema: [\n")), "baseline.yaml, line 2, column 1"),
        (("check",), "the following arguments are required: DIR"),
    ]
    for arguments, message in cases:
        ending = cli(*arguments)
        assert (ending.code, ending.out) == (2, "")
        assert message in ending.err
