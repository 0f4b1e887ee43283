"""Entry point: what each command line prints, leaves behind and exits with."""

import json
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml
from support.engines import ASKED
from support.printed import without_caveats

from runner.cli import commands
from runner.cli.main import GUIDE
from runner.cli.parser import build_parser
from runner.config.compose.files import groups
from runner.store import open_sweep
from runner.sweeps import job

SHORT = ("robot=macro", "duration=0.05")
VERSION = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())["project"]["version"]
IN_PROCESS = ("hydra.sweeper.workers=0",)


@pytest.mark.parametrize("flag", ["-h", "--help", "help"])
def test_help_names_every_command(cli, flag):
    ending = cli(flag)
    assert ending.code == 0
    lines = ending.out.splitlines()
    listed = [line[2:].partition("  ")[0].split(", ") for line in lines if re.match(r"  [a-z]", line)]
    assert tuple(name for names in listed for name in names) == commands.names()
    assert all(group in lines for group in commands.groups())
    for name in ("--plugin GROUP=MODULE", "-q, --quiet", *groups(), "3 internal error"):
        assert name in ending.out
    assert max(map(len, lines)) <= 120


@pytest.mark.parametrize("name", commands.names())
def test_the_help_of_a_command_is_short_and_ends_with_an_example_that_parses(name, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setattr("runner.cli.arguments.find_folder", lambda text, kinds: Path(text))
    parser = build_parser([name]).commands[name]
    lines = parser.format_help().splitlines()
    assert len(lines) < 25
    assert lines[0].startswith("usage: runner ")
    assert (parser.description or "").partition("\n\n")[0].endswith(".")
    *_, example, common = lines
    assert common == "Options of every command: runner --help"
    assert "--quiet" not in "".join(lines)
    said, command = example.split(": ", 1)
    program, called, *words = shlex.split(command)
    assert (said, program) == ("Example", "runner")
    assert called == ("sweep" if name == "run" else name)
    assert len(words) < 8
    assert parser.parse_known_args(["--quiet", "--plugin", "controller=a.py", *words])[1] == []


def test_the_help_of_an_action_has_its_usage(capsys):
    with pytest.raises(SystemExit):
        build_parser(["study"]).parse_args(["study", "diff", "--help"])
    assert capsys.readouterr().out.startswith("usage: runner study diff [--all] [--json] OLD NEW\n\n  OLD ")


@pytest.mark.parametrize("command", ["run", "sweep", "report"])
def test_help_of_a_command_is_its_own(cli, capsys, command):
    with pytest.raises(SystemExit) as ended:
        cli(command, "--help")
    assert ended.value.code == 0
    printed = capsys.readouterr().out
    assert printed.startswith(f"usage: runner {'run' if command == 'sweep' else command} [-")


def test_help_and_usage_have_no_colours(cli, monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("FORCE_COLOR", "1")
    for words in (["--help"], ["report", "--nothing"]):
        ending = cli(*words)
        assert ending.out or "Usage: runner report [--format A,B]" in ending.err
        assert "\x1b" not in ending.out + ending.err
        assert "x1b" not in ending.err
    assert "\x1b" not in build_parser(["report"]).commands["report"].format_help()


def test_version(cli):
    assert cli("--version").out.strip() == VERSION


def test_unknown_command_names_the_nearest(cli):
    ending = cli("chek", "outputs")
    assert ending.code == 2
    assert ending.err.startswith("runner: unknown command 'chek'. Allowed: run, sweep,")


def test_a_bare_call_guides_and_makes_nothing(cli, tmp_path):
    ending = cli()
    assert (ending.code, ending.out, ending.err) == (0, GUIDE, "")
    assert len(GUIDE.splitlines()) <= 12
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("no_processes")
def test_the_guide_s_commands_work(cli):
    lines = [line.strip() for line in GUIDE.splitlines() if line.startswith("  runner ")]
    commands = [shlex.split(re.split(r"  +", line)[0])[1:] for line in lines if "FILE" not in line]
    assert len(commands) == 4
    for arguments in commands:
        assert cli(*arguments).code == 0, arguments


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["robot", "=", "macro"], "an override has no spaces around its '=': `runner robot=macro`"),
        (["robot", "=macro"], "an override has no spaces around its '=': `runner robot=macro`"),
    ],
)
def test_what_looks_like_a_command_is_one_line(cli, tmp_path, arguments, told):
    ending = cli(*arguments)
    assert (ending.code, ending.out, ending.err) == (2, "", f"runner: {told}\n")
    assert list(tmp_path.iterdir()) == []


def test_run_and_sweep_are_spelled_out_forms_of_overrides(cli):
    first = cli(*SHORT, ASKED)
    again = cli("run", *SHORT, ASKED)
    assert (again.code, again.folder) == (first.code, first.folder)
    assert "stored before in" in again.err
    swept = cli("sweep", *IN_PROCESS, *SHORT, ASKED, "seed=0,1")
    assert swept.folder == cli("-m", *IN_PROCESS, *SHORT, ASKED, "seed=0,1").folder
    assert "runner: 2 runs: 1 made, 1 stored before" in swept.err
    assert open_sweep(swept.folder).command.startswith("runner -m ")


def test_a_sweep_without_an_axis_is_told(cli):
    ending = cli("-m", *IN_PROCESS, *SHORT)
    assert ending.err.splitlines()[:2] == [
        "runner: nothing is swept, and a single run is made: no key has several values, as seed=0,1 has",
        "runner: 1 run",
    ]


def test_a_run_prints_its_folder_and_writes_nothing_but_outputs(cli, tmp_path):
    ending = cli(*SHORT, ASKED, "caveats.did_not_follow.share=1")  # it has no time to arrive
    assert ending.code == 0
    assert ending.err.splitlines()[0] == (
        f"runner: macro, operational_space, goal: 1 repetition, stored in outputs/runs/{ending.folder.name}"
    )
    assert [entry.name for entry in tmp_path.iterdir()] == ["outputs"]
    assert ending.folder.parent == tmp_path / "outputs" / "runs"
    assert sorted(entry.name for entry in ending.folder.iterdir()) == [
        "config.yaml",
        "metrics.json",
        "robot.urdf",
        "trace.parquet",
    ]


def test_the_same_command_again_simulates_nothing(cli, monkeypatch):
    first = cli(*SHORT)
    monkeypatch.setattr(job, "simulate_run", None)
    again = cli(*SHORT)
    assert (again.code, again.out) == (first.code, first.out)
    assert again.err == first.err.replace(", stored in", ", stored before in")


def test_outputs_may_stand_elsewhere(cli, tmp_path):
    ending = cli(*SHORT, f"outputs={tmp_path}/else/where")
    assert ending.folder.parent == tmp_path / "else" / "where" / "runs"


def test_interpolations_may_be_typed(cli):
    ending = cli(*SHORT, ASKED, "trajectory.start=${robot.goal}")
    assert ending.code == 0
    record = json.loads((ending.folder / "metrics.json").read_text())
    assert record["provenance"]["command"] == f"runner {' '.join(SHORT)} {ASKED} 'trajectory.start=${{robot.goal}}'"


def test_showing_the_config_runs_nothing(cli, tmp_path):
    ending = cli("--cfg", "job", "robot=mini")
    assert ending.code == 0
    assert yaml.safe_load(ending.out)["robot"]["name"] == "mini"
    assert list(tmp_path.iterdir()) == []


def test_a_sweep_stores_every_combination_and_its_table(cli, tmp_path):
    ending = cli("-m", *IN_PROCESS, "robot=macro,mini", "noise.position=0,1e-4", "duration=0.05")
    runs, process, *told, counts, _, following = ending.err.splitlines()
    assert (ending.code, runs, process) == (0, "runner: 4 runs", "runner: about 1 s on 1 process")
    assert [("caveats" in line, "differ beyond the swept axes with robot" in line) for line in told] == [
        (True, False),
        (False, True),
    ]
    assert counts == "runner: 4 runs: 4 made, 0 stored before, none of them failed"
    assert (
        following == "runner: next: `runner report latest`, `runner table latest`, `runner compare latest --by robot`"
    )
    sweep = open_sweep(ending.folder)
    assert [overrides[:2] for overrides in sweep.overrides] == [
        ("robot=macro", "noise.position=0"),
        ("robot=macro", "noise.position=0.0001"),
        ("robot=mini", "noise.position=0"),
        ("robot=mini", "noise.position=0.0001"),
    ]
    assert sorted(sweep.hashes) == sorted(run.name for run in (tmp_path / "outputs/runs").iterdir())
    assert [entry.name for entry in tmp_path.iterdir()] == ["outputs"]


def test_a_sweep_with_a_bad_cell_names_it_and_starts_nothing(cli, tmp_path):
    ending = cli("-m", *SHORT, "noise.position=1e-4,-1")
    assert (ending.code, ending.out) == (2, "")
    assert "[robot=macro duration=0.05 noise.position=-1] noise.position: must be 0 or more; found -1" in ending.err
    assert "nothing was started" in ending.err
    assert list(tmp_path.iterdir()) == []


def test_a_sweep_tells_in_a_table_what_failed(cli):
    overrides = ("plant=rk4", "controller.period=0.01,0.06", "controller.singularity_damping=0", "trajectory=quintic")
    ending = cli("-m", *IN_PROCESS, "robot=macro", *overrides)
    assert ending.code == 1
    *_, count, title, row, differs, made, _, _, _ = without_caveats(ending.err).splitlines()
    assert "plant.step" in differs  # which follows the period
    assert count == "runner: 1 run failed"
    assert title.split() == ["run", "why", "more", "in"]
    assert "controller.period=0.06" in row
    assert "failed in repetition 0 at t = 0.6 s (q1): diverged" in row
    assert (ending.folder.parents[2] / row.split()[-1]).is_file()
    again = cli("-m", *IN_PROCESS, "robot=macro", *overrides)
    assert made == "runner: 2 runs: 2 made, 0 stored before, 1 of them failed"
    assert (again.code, again.folder) == (1, ending.folder)
    assert "runner: 2 runs: 0 made, 2 stored before, 1 of them failed" in again.err
    assert "runner: 2 runs, 2 of them stored already" in again.err


def test_the_command_to_go_on_with_is_kept_with_a_sweep(cli):
    folder = cli("-m", *IN_PROCESS, *SHORT, "seed=0,1").folder
    command = "runner -m hydra.sweeper.workers=0 robot=macro duration=0.05 seed=0,1"
    assert json.loads((folder / "sweep.json").read_text())["command"] == command


def test_an_experiment_may_bring_its_axes(cli, tmp_path):
    own = tmp_path / "own" / "experiment"
    own.mkdir(parents=True)
    (own / "axes.yaml").write_text(
        "# @package _global_\nduration: 0.05\nhydra: {sweeper: {params: {seed: '0,1', noise.position: '0,1e-4'}}}\n"
    )
    ending = cli("-m", "--config-dir", tmp_path / "own", *IN_PROCESS, "experiment=axes", "seed=3")
    assert open_sweep(ending.folder).overrides == [
        ("seed=3", f"noise.position={value}", "experiment=axes") for value in ("0", "0.0001")
    ]


def test_a_sweep_over_an_unknown_option_starts_nothing(cli, tmp_path):
    ending = cli("-m", "robot=macro,makro", "duration=0.05")
    assert ending.code == 2
    assert "[robot=makro duration=0.05] robot: no 'makro' (did you mean macro?)" in ending.err
    assert list(tmp_path.iterdir()) == []


def test_a_diverging_simulation_is_a_stored_result(cli):
    overrides = ("plant=rk4", "controller.period=0.06", "controller.singularity_damping=0", "trajectory=quintic")
    ending = cli("robot=macro", *overrides, "repetitions=2")
    assert ending.code == 1
    assert "failed in repetition 0 at t = 0.6 s (q1): diverged: not finite or above 1e+06 rad/s" in ending.err
    record = json.loads((ending.folder / "metrics.json").read_text())
    assert record["status"] == "failed"
    assert record["failure"]["joint"] == "q1"
    assert all(value is None for metric in record["metrics"].values() for value in metric["values"])
    assert cli("robot=macro", *overrides, "repetitions=2") == ending  # cached, it is printed again


def test_an_internal_error_ends_with_3_and_its_trace(cli, monkeypatch):
    def break_down(*_):
        raise ValueError("a bug")

    monkeypatch.setattr(job, "simulate_run", break_down)
    ending = cli(*SHORT)
    assert (ending.code, ending.out) == (3, "")
    assert "Traceback (most recent call last):" in ending.err
    assert "in break_down" in ending.err
    assert ending.err.splitlines()[-1] == (
        "runner: internal error: ValueError: a bug. Report it with the command and the trace above."
    )


def test_quiet_prints_the_folder_and_nothing_else(cli):
    loud = cli(*SHORT)
    quiet = cli("-q", *SHORT, "seed=1")
    assert (quiet.code, quiet.err, quiet.out) == (0, "", f"{quiet.folder.relative_to(Path.cwd())}\n")
    assert cli(*SHORT, "--quiet").out == loud.out
    checked = cli("check", quiet.folder, "-q")
    assert (checked.out, "no bundled baseline" in checked.err) == ("", True)


def test_quiet_shows_the_messages_of_a_failure(cli):
    overrides = ("plant=rk4", "controller.period=0.06", "controller.singularity_damping=0", "trajectory=quintic")
    ending = cli("robot=macro", *overrides, "-q")
    assert ending.code == 1
    assert "failed in repetition 0 at t = 0.6 s (q1)" in ending.err
    assert ending.out.count("\n") == 1
    assert "unknown key" not in cli("-q", "robot=makro").out


def test_output_and_jobs_of_runs_and_sweeps(cli, tmp_path):
    run = cli("run", *SHORT, "-o", tmp_path / "else where")
    assert run.folder.parent == tmp_path / "else where" / "runs"
    sweep = cli("sweep", *SHORT, "seed=0,1", "-j", "1", f"--output={tmp_path / 'other'}")
    assert (sweep.code, sweep.folder.parent) == (0, tmp_path / "other" / "sweeps")
    assert "seed=0,1 -j 1 --output=" in open_sweep(sweep.folder).command
    assert cli(*SHORT, "-j", "2").err == "runner: --jobs: one run uses one process. Add -m for a sweep.\n"
    assert "-j/--jobs: not a count ('0'). Allowed: a whole number, 1 or more." in cli("sweep", *SHORT, "-j", "0").err


def test_too_little_memory_is_said(cli, monkeypatch):
    def run_out(*_):
        raise MemoryError("unable to allocate 2 TiB")

    monkeypatch.setattr(job, "simulate_run", run_out)
    ending = cli(*SHORT)
    assert ending.code == 2
    assert ending.err == (
        "runner: not enough memory: unable to allocate 2 TiB; shorten the run or ask for fewer repetitions\n"
    )


def test_hydra_s_own_help(cli, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        cli("--hydra-help")
    printed = capsys.readouterr()
    assert (ended.value.code, printed.err) == (0, "")
    assert "--config-dir" in printed.out
    assert list(tmp_path.iterdir()) == []


LIGHT = [
    ["--help"], ["list", "robots"], ["nosuch"], ["report", "nosuch"], ["table", "nosuch"], ["status", "nosuch"],
    ["check", "nosuch"], ["compare", "nosuch", "nosuch"], ["verify", "nosuch"], ["doctor", "nosuch"],
    ["report", "latest"], ["table", "--nosuch"], ["tune", "robot=macro"],
    ["reproduce", "nosuch"], ["study", "check", "nosuch"],
]  # fmt: skip
IMPORTS = """\
import sys
from runner.cli.main import dispatch
heavy = {"numpy", "scipy", "pandas", "pydantic", "yaml", "pinocchio", "pybullet", "hydra", "omegaconf", "pyarrow"}
found = []
for arguments in LIGHT:
    dispatch(arguments)
    new = heavy.intersection(sys.modules)
    found += [(arguments, sorted(new))] if new else []
    heavy -= new
print(found)
"""


def test_what_needs_no_config_imports_little(tmp_path):
    """Help, lists, and folders that do not exist or are of a kind that the command does not take."""
    command = [sys.executable, "-c", f"LIGHT = {LIGHT}\n{IMPORTS}"]
    ending = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ending.stdout.splitlines()[-1] == "[]"
