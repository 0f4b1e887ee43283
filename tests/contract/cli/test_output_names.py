"""Outputs folders with any name: `-o` takes the name letter by letter."""

import pytest

SHORT = ("robot=macro", "duration=0.05")
STRANGE = 'Übung #1 (a=b), [it\'s] 50% "x" ~null\\'
FORBIDDEN = "runs of ${robot.name}"


def test_an_outputs_folder_may_have_any_name(cli, tmp_path):
    outputs = tmp_path / STRANGE
    run = cli(*SHORT, "-o", STRANGE).folder
    assert run.parent == outputs / "runs"
    sweep = cli("-m", *SHORT, "gravity=9.7,9.8", "hydra.sweeper.workers=0", "-o", STRANGE).folder
    assert sweep.parent == outputs / "sweeps"
    assert cli("check", f"{STRANGE}/latest", "--save-baseline", "b.yaml").code == 0
    assert len(cli("results", STRANGE).out.splitlines()) == 3


@pytest.mark.parametrize("name", ["null", "1e3", "true", "a,b", "#", "'", "Ü"])
def test_a_short_name_is_no_other_value(cli, tmp_path, name):
    assert cli(*SHORT, "-o", name).folder.parent == tmp_path / name / "runs"


@pytest.mark.parametrize("words", [SHORT, ("tune", "robot=macro", "--minimize", "peak_torque"), ("calibrate",)])
def test_a_name_with_a_reference_is_refused(cli, words):
    ending = cli(*words, "-o", FORBIDDEN)
    assert (ending.code, ending.out) == (2, "")
    assert f"outputs: '${{' begins a reference ('{FORBIDDEN}'). Choose a name without it" in ending.err
    assert "invalid config" not in ending.err


def test_the_settings_may_name_any_folder(cli, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    (tmp_path / "arm-control-runner").mkdir()
    (tmp_path / "arm-control-runner" / "config.yaml").write_text("outputs: Übung, it's\n")
    assert cli(*SHORT).folder.parent == tmp_path / "Übung, it's" / "runs"
