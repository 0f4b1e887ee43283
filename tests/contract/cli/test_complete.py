"""Words that complete a half typed line."""

import pytest

from runner.cli import commands
from runner.cli.list import TOPICS
from runner.config.compose.files import group_options
from runner.plugins.metric_units import units


@pytest.fixture
def stored(tmp_path):
    """Put what may be stored into ./outputs."""
    for kind in ("runs", "sweeps", "tunings"):
        (tmp_path / "outputs" / kind / f"of_{kind}").mkdir(parents=True)


def test_commands_stand_first(tab):
    assert set(commands.names()) < set(tab(""))
    assert tab("rep") == ["repetitions=", "report", "reproduce"]
    assert "report" not in tab("robot=macro ")
    assert {"run", "sweep"} < set(tab(""))
    assert tab("run robot=min") == tab("sweep robot=min") == ["robot=mini"]


def test_topics(tab):
    assert tab("list ") == sorted(TOPICS)
    assert tab("list robots ") == []


def test_options_are_those_of_the_command(tab):
    assert tab("report --") == ["--by", "--format", "--help", "--metrics", "--output", "--plugin", "--quiet"]
    assert tab("tune robot=macro --min") == ["--minimize"]
    assert tab("study diff --") == ["--all", "--help", "--json"]


def test_every_command_tells_its_options(tab):
    assert [command for command in commands.names() if "--help" not in tab(f"{command} -")] == []


def test_values_of_options(tab):
    assert tab("tune robot=macro --minimize ") == sorted(units())
    assert tab("tune robot=macro --minimize=settling") == ["--minimize=settling_time"]
    assert tab("tune --trials 5 robot=min") == ["robot=mini"]
    assert tab("tune --trials ") == []


def test_lists_of_options(tab):
    assert tab("sensitivity latest --metrics peak_torque,sett") == ["peak_torque,settling_time"]
    assert tab("sensitivity latest --parameters gains,m") == ["gains,masses", "gains,mismatch"]
    assert tab("doctor arm.urdf --format ") == ["config", "html"]
    assert tab("challenge latest --without noise,de") == ["noise,delay"]
    assert tab("challenge latest --vary no") == ["noise=", "noise_kind="]


def test_metrics_are_read_once(monkeypatch, tab):
    first = tab("tune --minimize ")
    monkeypatch.setitem(TOPICS, "metrics", None)
    assert tab("tune --minimize ") == first


def test_studies(tab):
    assert {"thesis", "all", "audit"} < set(tab("reproduce "))
    assert tab("reproduce xa") == ["xarm7"]
    assert tab("study ") == ["check", "diff", "new"]
    assert "audit" not in tab("study check ")


@pytest.mark.usefixtures("stored")
def test_stored_folders_of_the_kinds_that_a_command_takes(tab):
    assert tab("report ") == [
        "latest",
        "outputs/runs/of_runs",
        "outputs/sweeps/of_sweeps",
        "outputs/tunings/of_tunings",
    ]
    both = ["latest", "outputs/runs/of_runs", "outputs/sweeps/of_sweeps"]
    assert tab("compare outputs/runs/of_runs ") == both
    assert tab("status outputs/s") == ["outputs/sweeps/", "outputs/sweeps/of_sweeps"]


def test_many_stored_folders_are_named_by_the_one_that_they_lie_in(tmp_path, tab):
    for number in range(51):
        (tmp_path / "outputs" / "runs" / f"{number:03}").mkdir(parents=True)
    assert tab("report ") == ["latest", "outputs/runs/"]
    assert "outputs/runs/049" in tab("report outputs/runs/04")


def test_options_of_groups_nested_ones_too(tab):
    assert tab("robot=m") == [f"robot={name}" for name in group_options("robot") if name.startswith("m")]
    assert "experiment=thesis/figure_3_5" in tab("experiment=thesis/")
    assert tab("calibrate calibration=g") == ["calibration=gravity"]


def test_the_next_of_a_list(tab):
    found = tab("-m robot=macro,")
    assert "robot=macro,mini" in found
    assert "robot=macro,macro" not in found
    assert tab("-m robot=macro,mini,xarm7_") == ["robot=macro,mini,xarm7_mini"]


@pytest.mark.parametrize("option", ["--config-dir mine", "--config-dir=mine", "-cd mine"])
def test_options_of_own_config_folders(tmp_path, option, tab):
    (tmp_path / "mine" / "robot").mkdir(parents=True)
    (tmp_path / "mine" / "robot" / "lbr.yaml").write_text("# An arm\n")
    assert tab(f"{option} robot=l") == ["robot=lbr"]
    assert tab("robot=l") == []


def test_config_folders_themselves(tmp_path, tab):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine.txt").touch()
    assert tab("--config-dir m") == ["mine/"]
    assert tab("tune --config-dir m") == ["mine/"]


def test_plug_ins(tmp_path, tab):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "spring.py").touch()
    (tmp_path / "mine" / "notes.txt").touch()
    assert tab("--plugin con") == ["controller="]
    assert tab("--plugin controller=mine/") == ["controller=mine/spring.py"]
    assert tab("--plugin=controller=mine/s") == ["--plugin=controller=mine/spring.py"]
    assert tab("--plugin controller=mine/spring.py controller=sp") == ["controller=spring"]
    assert tab("--plugin controller=mine/laws.py:my_pd controller=my") == ["controller=my_pd"]
    assert "trajectory=spring" not in tab("--plugin controller=mine/spring.py trajectory=")
    assert tab("report --plugin metric=mine/s") == ["metric=mine/spring.py"]


def test_keys_and_their_values(tab):
    assert tab("dura") == ["duration="]
    assert {"controller.", "controller=", "limits."} < set(tab(""))
    assert tab("robot=xarm7 controller.per") == ["controller.period="]
    assert tab("robot=macro controller.period=") == ["controller.period=0.01"]
    assert tab("robot=macro robot.home.") == ["robot.home.0=", "robot.home.1=", "robot.home.2="]
    assert tab("robot=combined robot.stages.ma") == ["robot.stages.macro."]
    assert tab("+noise.dist") == ["+noise.distribution="]


def test_keys_are_those_of_the_typed_choice(tab):
    assert tab("trajectory=circle trajectory.") != tab("trajectory=goal trajectory.")


def test_keys_are_composed_once_for_a_line(monkeypatch, tab):
    first = tab("robot=mini controller.")
    monkeypatch.setattr("runner.config.compose.composer.Composer", None)
    assert tab("robot=mini controller.") == first
    assert tab("robot=macro controller.") == []


def test_the_line_ends_at_the_cursor(tab):
    assert "robot=macro" in tab("robot=m seed=1", point=len("runner robot=m"))


@pytest.mark.parametrize("program", ["runner", "./bin/runner", "python -m runner", "python3 run.py"])
def test_the_program_is_no_word_of_the_line(program, tab):
    assert tab("list rob", program) == ["robots"]


def test_options_may_stand_between_overrides(tab):
    assert tab("robot=macro -m robot=mi") == ["robot=mini"]
    assert tab("tune robot=xarm7 --trials 5 controller.per") == ["controller.period="]
    assert tab("tune robot=xarm7 --trials 5 controller.period=0.01 --minimize settling") == ["settling_time"]
    assert tab("calibrate --config-dir nosuch calibration=g") == ["calibration=gravity"]


def test_a_wrong_word_before_does_not_end_completion(tab):
    assert tab("report nosuch --met") == ["--metrics"]
    assert tab("tune --trials x --minimize settling") == ["settling_time"]


def test_values_are_typed_as_in_an_override(tmp_path, tab):
    (tmp_path / "mine" / "robot").mkdir(parents=True)
    text = "# @package _global_\nrobot: {name: true, tip: '${robot.nothing}'}\n"
    (tmp_path / "mine" / "robot" / "odd.yaml").write_text(text)
    assert tab("--config-dir mine robot=odd robot.name=") == ["robot.name=true"]
    assert tab("--config-dir mine robot=odd robot.tip=") == []
    assert tab("--config-dir mine robot=odd robot.ti") == ["robot.tip="]


def test_a_spec_offers_the_metrics_and_what_a_bound_has(tab):
    assert tab("robot=macro spec.metrics.settl") == ["spec.metrics.settling_time."]
    assert len(tab("spec.metrics.")) == len(units())
    ends = [f"spec.metrics.overshoot.{key}=" for key in ("max", "min", "reason")]
    assert tab("spec.metrics.overshoot.") == ends
    assert tab("spec=") == ["spec=none"]
