import json

import pytest
from engines import ASKED

from runner.store.stored import write_job

SHORT = ("robot=macro", "duration=0.05")


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


def test_a_run_and_itself(cli):
    run = cli(*SHORT).folder
    ending = cli("diff", run, run)
    assert (ending.code, ending.err) == (0, "")
    assert "same config\nsame provenance\n" in ending.out
    unit, a, b, difference, ratio = cells(ending.out, "peak_joint_speed")
    assert (unit, a, difference, ratio) == ("rad/s", b, "0", "1")


def test_config_keys_and_metrics_that_differ(cli):
    a = cli(*SHORT, "trajectory=quintic", "trajectory.duration=0.5").folder
    changes = ("trajectory.duration=0.4", "torque_limits.max=[50,50,20]", "plant=rk4", "plant.step=0.001")
    b = cli(*SHORT, "trajectory=quintic", *changes).folder
    out = cli("diff", a, b).out
    head, table = out.split("config differs:")[1].split("same provenance")
    assert cells(head, "trajectory.duration") == ["0.5", "0.4"]
    assert cells(head, "torque_limits.max") == ["null", "[50,", "50,", "20]"]
    assert cells(head, "plant.kind") == [ASKED.removeprefix("plant="), "rk4"]
    assert cells(head, "plant.step") == ["null", "0.001"]
    assert "outputs" not in head
    assert "controller" not in head
    _, found_a, found_b, difference, ratio = cells(table, "energy")
    assert float(difference) == pytest.approx(float(found_b) - float(found_a), rel=1e-3)
    assert float(ratio) == pytest.approx(float(found_b) / float(found_a), rel=1e-3)


def test_caveats_of_either(cli):
    a, b = cli(*SHORT).folder, cli(*SHORT, "seed=1").folder
    change(a, lambda record: record.update(caveats=[]))
    caveat = {"rule": "saturation", "text": "joint q1 is at its torque limit", "value": 0.5, "repetitions": 1}
    assert "\nno caveats\n" in cli("diff", a, a).out
    change(b, lambda record: record.update(caveats=[caveat]))
    assert "\ncaveats:\n  B  saturation  joint q1 is at its torque limit\n" in cli("diff", a, b).out


def test_keys_and_metrics_of_one_run_only(cli):
    a = cli(*SHORT).folder
    b = cli(*SHORT, "trajectory=quintic").folder
    out = cli("diff", a, b).out
    assert cells(out, "trajectory.duration") == ["(absent)", "3.0"]
    assert cells(out, "max_tracking_error")[:2] == ["m", "-"]
    assert cells(out, "max_tracking_error")[3:] == ["-", "-"]


def test_provenance_and_robots_that_differ(cli):
    a, b = cli(*SHORT).folder, cli(*SHORT, "seed=1").folder
    (b / "robot.urdf").write_text("<robot/>")
    change(b, lambda record: record["provenance"].update(commit="abc", plant_step=5e-4))
    change(b, lambda record: record["provenance"]["versions"].update(pin="9.9"))
    out = cli("diff", a, b).out
    assert "  the text of robot.urdf differs\nprovenance differs:\n" in out
    assert cells(out, "commit")[-1] == "abc"
    assert cells(out, "versions.pin")[-1] == "9.9"
    assert cells(out, "plant_step") == ["0.001", "0.0005"]


def test_a_failed_run_says_why(cli):
    overrides = ("plant=rk4", "controller.period=0.06", "controller.singularity_damping=0", "trajectory=quintic")
    run = cli("robot=macro", *overrides).folder
    assert f"B  {run}  failed in repetition 0 at t = 0.6 s (q1): diverged" in cli("diff", run, run).out


def test_a_ratio_to_zero_is_left_out(cli):
    run = cli(*SHORT).folder
    assert cells(cli("diff", run, run).out, "saturation_fraction") == ["1", "0", "0", "0", "-"]


def test_folders_that_are_no_runs(cli, tmp_path):
    run = cli(*SHORT).folder
    sweep = cli("-m", "hydra.sweeper.workers=0", *SHORT, "seed=0,1").folder
    for bad, what in ((tmp_path / "gone", "no folder"), (tmp_path, "is no stored run"), (sweep, "is a sweep")):
        for pair in ((run, bad), (bad, run)):
            ending = cli("diff", *pair)
            assert (ending.code, ending.out) == (2, "")
            assert what in ending.err


def test_two_folders_are_needed(cli):
    ending = cli("diff", "one")
    assert ending.code == 2
    assert ending.err == "runner: the following arguments are required: B; usage: runner diff [-h] A B\n"


def test_equal_seeds_are_compared_in_pairs(cli):
    case = (*SHORT, "trajectory=quintic", "noise=thesis", "repetitions=6")
    a, b = cli(*case).folder, cli(*case, "noise.position=2e-3").folder
    _, paired = cli("diff", a, b).out.split("in 6 pairs on the same seeds")
    line = next(line for line in paired.splitlines() if line.split()[:1] == ["rms_torque"])
    *_, effect, p_value, _ = line.split()
    assert (float(effect), float(p_value)) == (1.0, pytest.approx(2 / 2**6, rel=0.02))  # twice the noise, every time
    assert line.endswith("larger")


@pytest.mark.parametrize(
    ("other", "reason"),
    [
        (("seed=1", "repetitions=6"), "not compared in pairs: seed 0 and seed 1 share no noise"),
        (("repetitions=5",), "not compared in pairs: 5 repetitions in common, and 6 are needed"),
    ],
)
def test_what_makes_no_pairs_is_said(cli, other, reason):
    a, b = cli(*SHORT, "repetitions=6").folder, cli(*SHORT, *other).folder
    assert reason in cli("diff", a, b).out
