"""`runner compare` of stored runs: what differs, in pairs or not, and what is refused."""

import json
import shutil
from dataclasses import replace

import pytest
from fixtures.stored import SHORT
from support.engines import ASKED

import runner
from runner.base.machine import this_machine
from runner.store.seal import write_job


def change(folder, edit):
    """Edit a stored run's record, digests as they should be."""
    record = json.loads((folder / "metrics.json").read_text())
    edit(record)
    files = {name: (folder / name).read_bytes() for name in record["files"]}
    content = {key: value for key, value in record.items() if key not in ("schema", "digest", "files")}
    write_job(folder, "metrics.json", content, files)


def cells(text, name):
    """Return the cells of the line that starts with a name."""
    return next(line.split()[1:] for line in text.splitlines() if line.split()[:1] == [name])


def test_a_run_and_itself(cli, copy_run):
    run = copy_run("goal")
    ending = cli("compare", run, run, "--all")
    assert (ending.code, ending.err) == (0, "")
    assert "same config\nsame provenance\n" in ending.out
    unit, a, b, difference, ratio = cells(ending.out, "peak_joint_speed")
    assert (unit, a, difference, ratio) == ("rad/s", b, "0", "1")


def test_config_keys_and_metrics_that_differ(cli, copy_run):
    a = copy_run("quintic")
    changes = ("trajectory.duration=0.4", "torque_limits.max=[50.5,50.5,20.5]", "plant=rk4", "plant.step=0.001")
    b = cli(*SHORT, "trajectory=quintic", "noise=thesis", *changes).folder
    out = cli("compare", a, b, "--all").out
    head, table = out.split("config differs:")[1].split("same provenance")
    assert cells(head, "trajectory.duration") == ["1.0", "0.4"]
    assert cells(head, "torque_limits.max") == ["null", "[50.5,", "50.5,", "20.5]"]
    assert cells(head, "plant.kind") == [ASKED.removeprefix("plant="), "rk4"]
    assert cells(head, "plant.step") == ["null", "0.001"]
    assert "outputs" not in head
    assert "controller" not in head
    _, found_a, found_b, difference, ratio = cells(table, "energy")
    assert float(difference) == pytest.approx(float(found_b) - float(found_a), rel=1e-3)
    assert float(ratio) == pytest.approx(float(found_b) / float(found_a), rel=1e-3)


def test_caveats_of_either(cli, copy_run):
    a, b = copy_run("goal"), copy_run("other seed")
    change(a, lambda record: record.update(caveats=[]))
    caveat = {"rule": "saturation", "text": "joint q1 is at its torque limit", "value": 0.5}
    assert "May mislead" not in cli("compare", a, a).out
    change(b, lambda record: record.update(caveats=[caveat]))
    expected = "\nMay mislead: saturation (B): joint q1 is at its torque limit.\n"
    assert expected in cli("compare", a, b).out


def test_keys_and_metrics_of_one_run_only(cli, copy_run):
    a, b = copy_run("goal"), copy_run("pairs")
    out = cli("compare", a, b, "--all").out
    assert cells(out, "trajectory.duration") == ["(absent)", "3.0"]
    assert cells(out, "max_tracking_error")[:2] == ["m", "-"]
    assert cells(out, "max_tracking_error")[3:] == ["-", "-"]


def test_provenance_and_robots_that_differ(cli, copy_run):
    a, b = copy_run("goal"), copy_run("other seed")
    (b / "robot.urdf").write_text((b / "robot.urdf").read_text() + "<!-- another -->\n")
    change(b, lambda record: record["provenance"].update(commit="abc", plant_step=5e-4))
    change(b, lambda record: record["provenance"]["versions"].update(pin="9.9"))
    out = cli("compare", a, b).out
    assert "  the text of robot.urdf differs\nprovenance differs:\n" in out
    assert cells(out, "commit")[-1] == "abc"
    assert cells(out, "versions.pin")[-1] == "9.9"
    assert cells(out, "plant_step") == ["0.001", "0.0005"]


def test_equal_runs_of_two_machines_differ_in_the_machine_alone(cli, copy_run, tmp_path):
    a = copy_run("goal")
    b = shutil.copytree(a, tmp_path / "elsewhere" / "runs" / a.name)
    for run, core in ((a, "Haswell"), (b, "SkylakeX")):
        machine = replace(this_machine(), openblas=core).record()
        change(run, lambda record, machine=machine: record["provenance"].update(machine=machine))
    out = cli("compare", a, b).out
    expected = "A and B differ only in the machine: OpenBLAS Haswell against OpenBLAS SkylakeX."
    assert f"\n{expected} What follows may be rounding, which can grow.\nsame config\n" in out
    assert cells(out, "machine.openblas") == ["Haswell", "SkylakeX"]
    assert "differ in no value" not in out


def test_a_failed_run_says_why(cli, copy_run):
    run = copy_run("failed")
    assert f"B  {run}  failed in repetition 0 at t = 0.6 s (q1): diverged" in cli("compare", run, run).out


def test_a_ratio_to_zero_is_left_out(cli, copy_run):
    run = copy_run("goal")
    assert cells(cli("compare", run, run, "--all").out, "saturation_fraction") == ["1", "0", "0", "0", "-"]


def test_folders_that_are_no_runs(cli, copy_run, tmp_path):
    run = copy_run("goal")
    for bad, what in ((tmp_path / "gone", "no such folder"), (tmp_path, "it is not the folder of a stored result")):
        for pair in ((run, bad), (bad, run)):
            ending = cli("compare", *pair)
            assert (ending.code, ending.out) == (2, "")
            assert what in ending.err


def test_one_run_alone_is_refused(cli, copy_run):
    ending = cli("compare", copy_run("goal"))
    assert (ending.code, ending.out) == (2, "")
    assert "only one run. Add a second one" in ending.err


def test_what_is_compared_is_told_before_any_number(cli, copy_run):
    a = copy_run("goal")
    b, one = (cli(*SHORT, *other, "gravity=9.7").folder for other in (("controller.period=0.005",), ()))
    assert "\nA and B differ only in gravity: 9.81 against 9.7.\n" in cli("compare", a, one).out
    expected = next(line for line in cli("compare", a, b).out.splitlines() if line.startswith("A and B differ"))
    assert "gravity (9.81 against 9.7), and also in " in expected
    assert "controller.period" in expected
    assert expected.endswith("may be due to any of these.")
    assert "\nA and B differ in no value.\nsame config\n" in cli("compare", a, a).out


def test_several_runs_are_held_against_the_first(cli, copy_run):
    runs = [copy_run(name) for name in ("goal", "other seed", "noise")]
    out = cli("compare", *runs, "--metrics", "energy").out
    blocks = out.split(f"A  {runs[0]}  ok")[1:]
    assert ["C differ only in noise" in block for block in blocks] == [False, True]
    assert cells(blocks[1].split("metric")[1], "energy")[0] == "J"
    assert "peak_torque" not in out


def test_an_unknown_metric_is_refused(cli, copy_run):
    run = copy_run("goal")
    ending = cli("compare", run, run, "--metrics", "enrgy")
    assert (ending.code, ending.out) == (2, "")
    assert "metrics: unknown metric 'enrgy'. Allowed: " in ending.err


def test_equal_seeds_are_compared_in_pairs(cli, copy_run):
    a, b = copy_run("pairs"), copy_run("more noise")
    out = cli("compare", a, b, "--metrics", "rms_torque,peak_torque", "--all").out
    assert "\nRms torque: " in out
    assert "smaller with A than with B (" in out
    line = [line for line in out.splitlines() if line.split()[:1] == ["rms_torque"]][-1]
    *_, n, effect, p_value, _ = line.split()
    assert n == "6"
    assert (float(effect), float(p_value)) == (1.0, pytest.approx(2 / 2**6, rel=0.02))  # twice the noise, every time
    assert line.endswith("larger")


@pytest.mark.parametrize(
    ("one", "other", "reason"),
    [
        ("goal", "other seed", "not compared in pairs: seed 0 and seed 1 share no noise"),
        ("pairs", "noise", "not compared in pairs: 2 repetitions in common, and 6 are needed"),
    ],
)
def test_what_makes_no_pairs_is_said(cli, copy_run, one, other, reason):
    assert reason in cli("compare", copy_run(one), copy_run(other)).out


def test_json_has_the_rows_of_the_function(cli, copy_run):
    a, b = copy_run("pairs"), copy_run("more noise")
    ending = cli("compare", a, b, "--metrics", "rms_torque,peak_torque", "--json")
    assert (ending.code, ending.err) == (0, "")
    found = runner.compare(a, b, metrics=["rms_torque", "peak_torque"])
    assert json.loads(ending.out) == found.to_dict(orient="records")


def test_a_run_that_failed_is_beyond_every_number_of_the_other(cli):
    asked = ("robot=macro", "plant=rk4", "trajectory=quintic", "duration=1", "noise=thesis", "repetitions=6")
    good = cli(*asked).folder
    bad = cli(*asked, "controller.singularity_damping=0", "controller.period=0.06").folder
    out = cli("compare", good, bad).out
    assert "smaller with A than with B (never): by more than any number in pairs (beyond every number, 6 pairs" in out
    assert "no metric is in both" not in out
