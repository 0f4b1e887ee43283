"""Words that complete a half typed line."""

import pytest

from runner.cli.completion.complete import complete
from runner.cli.completion.line import read_line
from runner.cli.help import COMMANDS
from runner.cli.list import TOPICS
from runner.config.compose.options import group_options
from runner.plugins.metric_units import units


def words(line):
    return sorted({*complete(read_line({"COMP_LINE": f"runner {line}"}))})


@pytest.fixture(autouse=True)
def own_place(tmp_path, tmp_path_factory, monkeypatch):
    monkeypatch.chdir(tmp_path)
    place = tmp_path_factory.mktemp("cache")
    monkeypatch.setattr("runner.symbolic.cache.folder", lambda: place)


@pytest.fixture
def stored(tmp_path):
    """Put what may be stored into ./outputs."""
    for kind in ("runs", "sweeps", "tunings"):
        (tmp_path / "outputs" / kind / f"of_{kind}").mkdir(parents=True)


def test_commands_stand_first():
    assert set(COMMANDS) < set(words(""))
    assert words("rep") == ["repetitions=", "report", "reproduce"]
    assert "report" not in words("robot=macro ")
    assert {"run", "sweep"} < set(words(""))
    assert words("run robot=min") == words("sweep robot=min") == ["robot=mini"]


def test_topics():
    assert words("list ") == sorted(TOPICS)
    assert words("list robots ") == []


def test_options_are_those_of_the_command():
    assert words("report --") == ["--help", "--html", "--metrics", "--pdf"]
    assert words("tune robot=macro --min") == ["--minimize"]
    assert words("study diff --") == ["--all", "--help", "--json"]


def test_every_command_tells_its_options():
    assert [command for command in COMMANDS if "--help" not in words(f"{command} -")] == []


def test_values_of_options():
    assert words("tune robot=macro --minimize ") == sorted(units())
    assert words("tune robot=macro --minimize=settling") == ["--minimize=settling_time"]
    assert words("tune --trials 5 robot=min") == ["robot=mini"]
    assert words("tune --trials ") == []


def test_lists_of_options():
    assert words("sensitivity latest --metrics peak_torque,sett") == ["peak_torque,settling_time"]
    assert words("sensitivity latest --parameters gains,m") == ["gains,masses", "gains,mismatch"]
    assert words("doctor arm.urdf --format ") == ["config", "html"]


def test_metrics_are_read_once(monkeypatch):
    first = words("tune --minimize ")
    monkeypatch.setitem(TOPICS, "metrics", None)
    assert words("tune --minimize ") == first


def test_studies():
    assert {"thesis", "all", "audit"} < set(words("reproduce "))
    assert words("reproduce xa") == ["xarm7"]
    assert words("study ") == ["check", "diff", "new"]
    assert "audit" not in words("study check ")


@pytest.mark.usefixtures("stored")
def test_stored_folders_of_the_kinds_that_a_command_takes():
    assert words("report ") == [
        "latest",
        "outputs/runs/of_runs",
        "outputs/sweeps/of_sweeps",
        "outputs/tunings/of_tunings",
    ]
    both = ["latest", "outputs/runs/of_runs", "outputs/sweeps/of_sweeps"]
    assert words("compare outputs/runs/of_runs ") == both
    assert words("status outputs/s") == ["outputs/sweeps/", "outputs/sweeps/of_sweeps"]


def test_many_stored_folders_are_named_by_the_one_that_they_lie_in(tmp_path):
    for number in range(51):
        (tmp_path / "outputs" / "runs" / f"{number:03}").mkdir(parents=True)
    assert words("report ") == ["latest", "outputs/runs/"]
    assert "outputs/runs/049" in words("report outputs/runs/04")


def test_options_of_groups_nested_ones_too():
    assert words("robot=m") == [f"robot={name}" for name in group_options("robot") if name.startswith("m")]
    assert "experiment=thesis/figure_3_5" in words("experiment=thesis/")
    assert words("calibrate calibration=g") == ["calibration=gravity"]


def test_the_next_of_a_list():
    found = words("-m robot=macro,")
    assert "robot=macro,mini" in found
    assert "robot=macro,macro" not in found
    assert words("-m robot=macro,mini,xarm7_") == ["robot=macro,mini,xarm7_mini"]


@pytest.mark.parametrize("option", ["--config-dir mine", "--config-dir=mine", "-cd mine"])
def test_options_of_own_config_folders(tmp_path, option):
    (tmp_path / "mine" / "robot").mkdir(parents=True)
    (tmp_path / "mine" / "robot" / "lbr.yaml").write_text("# An arm\n")
    assert words(f"{option} robot=l") == ["robot=lbr"]
    assert words("robot=l") == []


def test_config_folders_themselves(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine.txt").touch()
    assert words("--config-dir m") == ["mine/"]
    assert words("tune --config-dir m") == ["mine/"]


def test_plug_ins(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "spring.py").touch()
    (tmp_path / "mine" / "notes.txt").touch()
    assert words("--plugin con") == ["controller="]
    assert words("--plugin controller=mine/") == ["controller=mine/spring.py"]
    assert words("--plugin=controller=mine/s") == ["--plugin=controller=mine/spring.py"]
    assert words("--plugin controller=mine/spring.py controller=sp") == ["controller=spring"]
    assert "trajectory=spring" not in words("--plugin controller=mine/spring.py trajectory=")
    assert words("report --plugin metric=mine/s") == ["metric=mine/spring.py"]


def test_keys_and_their_values():
    assert words("dura") == ["duration="]
    assert {"controller.", "controller=", "limits."} < set(words(""))
    assert words("robot=xarm7 controller.per") == ["controller.period="]
    assert words("robot=macro controller.period=") == ["controller.period=0.01"]
    assert words("robot=macro robot.home.") == ["robot.home.0=", "robot.home.1=", "robot.home.2="]
    assert words("robot=combined robot.stages.ma") == ["robot.stages.macro."]
    assert words("+noise.dist") == ["+noise.distribution="]


def test_keys_are_those_of_the_typed_choice():
    assert words("trajectory=circle trajectory.") != words("trajectory=goal trajectory.")


def test_keys_are_composed_once_for_a_line(monkeypatch):
    first = words("robot=mini controller.")
    monkeypatch.setattr("runner.config.compose.hydra_config.hydra_config", None)
    assert words("robot=mini controller.") == first
    with pytest.raises(TypeError):
        words("robot=macro controller.")


def test_the_line_ends_at_the_cursor():
    line = "runner robot=m seed=1"
    found = complete(read_line({"COMP_LINE": line, "COMP_POINT": str(len("runner robot=m"))}))
    assert "robot=macro" in found


@pytest.mark.parametrize("program", ["runner", "./bin/runner", "python -m runner", "python3 run.py"])
def test_the_program_is_no_word_of_the_line(program):
    assert list(complete(read_line({"COMP_LINE": f"{program} list rob"}))) == ["robots"]


def test_values_are_typed_as_in_an_override(tmp_path):
    (tmp_path / "mine" / "robot").mkdir(parents=True)
    text = "# @package _global_\nrobot: {name: true, tip: '${robot.nothing}'}\n"
    (tmp_path / "mine" / "robot" / "odd.yaml").write_text(text)
    assert words("--config-dir mine robot=odd robot.name=") == ["robot.name=true"]
    assert words("--config-dir mine robot=odd robot.tip=") == []
    assert words("--config-dir mine robot=odd robot.ti") == ["robot.tip="]


def test_a_spec_offers_the_metrics_and_what_a_bound_has():
    assert words("robot=macro spec.metrics.settl") == ["spec.metrics.settling_time."]
    assert len(words("spec.metrics.")) == len(units())
    ends = [f"spec.metrics.overshoot.{key}=" for key in ("max", "min", "reason")]
    assert words("spec.metrics.overshoot.") == ends
    assert words("spec=") == ["spec=none"]
