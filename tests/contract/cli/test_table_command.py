"""`runner table`: of runs and sweeps, in every format, to a file or the terminal."""

import json
import re

import pandas as pd
import pytest

from runner import run
from runner.store import write_sweep
from runner.sweeps.at_work import at_work

CASE = ("robot=macro", "trajectory=quintic", "duration=0.05", "noise.position=1e-4", "repetitions=6", "outputs=o")
CONTROLLERS = ("computed_torque", "operational_space")


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Two runs of six short repetitions, and the sweep of both, in a folder o."""
    folder = tmp_path_factory.mktemp("table")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        cells = [(f"controller={name}", *CASE) for name in CONTROLLERS]
        runs = [run(*overrides) for overrides in cells]
        write_sweep(folder / "o", [(own, each.hash) for own, each in zip(cells, runs, strict=True)], "runner -m ...")
    return folder


@pytest.fixture
def sweep(stored, monkeypatch):
    monkeypatch.chdir(stored)
    return next((stored / "o" / "sweeps").iterdir()).relative_to(stored)


@pytest.fixture
def a_run(stored, monkeypatch):
    monkeypatch.chdir(stored)
    return min((stored / "o" / "runs").iterdir()).relative_to(stored)


def test_a_table_for_a_paper_goes_to_standard_output_alone(cli, sweep):
    markdown = cli("table", sweep, "--format", "markdown", "--metrics", "rms_tracking_error")
    assert markdown.code == 0
    assert markdown.out.startswith("| controller | rms tracking error (")
    latex = cli("table", sweep, "--format", "latex", "--metrics", "rms_tracking_error")
    assert r"\toprule" in latex.out
    assert latex.out.rstrip().endswith(r"\end{tabular}")


@pytest.mark.parametrize(("name", "start"), [("t.tex", b"% Needs"), ("t.md", b"| contr"), ("t.csv", b"controller,"),
                                             ("t.parquet", b"PAR1")])  # fmt: skip
def test_the_ending_of_a_file_chooses_the_format(cli, sweep, name, start, tmp_path):
    ending = cli("table", sweep, "--output", tmp_path / name)
    assert ending.out == f"{tmp_path / name}\n"
    assert (tmp_path / name).read_bytes().startswith(start)


def test_a_selection_is_csv_unless_told_otherwise(cli, sweep):
    ending = cli("table", sweep, "--metrics", "peak_torque", "--where", "controller=computed_torque")
    lines = ending.out.splitlines()
    assert lines[0].startswith("cells,failed,peak_torque.median,")
    assert len(lines) == 2


def test_cells_are_chosen_by_any_value_of_their_configs(cli, sweep):
    swept = cli("table", sweep, "--metrics", "peak_torque", "--where", "controller=computed_torque").out
    values = ("controller.kind=computed_torque", "robot.name=macro", "duration=50ms", "robot=macro", "plant=bullet")
    by_config = [text for value in values for text in ("--where", value)]
    assert cli("table", sweep, "--metrics", "peak_torque", *by_config).out == swept
    both = cli("table", sweep, "--metrics", "peak_torque", "--by", "controller", "--where", "robot.name=macro")
    assert len(both.out.splitlines()) == 3
    ending = cli("table", sweep, "--where", "robot.name=mini")
    assert (ending.code, ending.err) == (2, "runner: --where robot.name: unknown value 'mini'. Allowed: macro.\n")
    assert "--where robot: unknown value 'mini'. Allowed: macro." in cli("table", sweep, "--where", "robot=mini").err
    unstored = cli("table", sweep, "--where", "noise=thesis").err
    assert "--where noise: a group whose option is not stored. Allowed: noise.position, " in unstored
    assert "unknown value '50mm'. Allowed: 0.05." in cli("table", sweep, "--where", "duration=50mm").err
    assert "--where: unknown axis 'robot.nam'" in cli("table", sweep, "--where", "robot.nam=macro").err


def test_a_run_has_a_table_of_its_metrics(cli, a_run):
    ending = cli("table", a_run)
    assert ending.out.startswith("| metric | unit | median")
    assert ending.out.splitlines()[-1] == str(a_run)
    record = json.loads((a_run / "metrics.json").read_text())
    frame = cli("table", a_run, "--format", "csv").out.splitlines()
    assert len(frame) == 1 + len(record["metrics"])
    assert cli("table", a_run, "--format", "latex", "--metrics", "peak_torque").code == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("--format", "latx"),
            "--format: unknown name 'latx'. Allowed: csv, parquet, markdown, latex, typst. Did you mean 'latex'?",
        ),
        (("--format", "parquet"), "--format: Parquet cannot be printed. Add --output FILE."),
        (("--output", "t.txt"), "--output t.txt: unknown ending '.txt'. Allowed: .csv, .parquet, .md, .tex, .typ."),
        (("--metrics", "peak_torq"), "metrics: unknown metric 'peak_torq'. Allowed: "),
        (("--by", "robot"), "--by: unknown axis 'robot'"),
        (("--where", "controller=pid"), "--where controller: unknown value 'pid'"),
    ],
)
def test_bad_input_is_one_line(cli, sweep, arguments, message):
    ending = cli("table", sweep, *arguments)
    assert ending.code == 2
    assert message in ending.err
    assert len(ending.err.splitlines()) == 1
    assert ending.out == ""


def test_axes_are_for_sweeps(cli, a_run):
    ending = cli("table", a_run, "--by", "controller")
    assert ending.code == 2
    assert f"--by and --where: {a_run} is a run. Allowed: only for sweeps." in ending.err


@pytest.fixture
def part(tmp_path):
    """A sweep of two cells; one is stored."""
    done = run(f"controller={CONTROLLERS[0]}", *CASE[:-1], f"outputs={tmp_path}/o")
    jobs = [(("controller=computed_torque",), done.hash), (("controller=operational_space",), "0" * 24)]
    return write_sweep(tmp_path / "o", jobs, "runner -m controller=computed_torque,operational_space")


@pytest.mark.parametrize("command", ["report", "check", "figures", "challenge", "table"])
def test_all_commands_say_the_same_of_a_sweep_that_lacks_runs(cli, part, command):
    ending = cli(command, part)
    assert ending.code == 2
    assert f"1 of 2 cells of {part} are not stored; continue with: runner -m controller=" in ending.err
    with at_work(part):
        ending = cli(command, part)
    assert ending.code == 2
    assert f"{part} is running, 1 of 2 cells are stored; wait, or watch it with: runner status" in ending.err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ("--format", "latex", "--width", "59"),
            "--width: not a width ('59'). Allowed: single (88 mm), double (180 mm)",
        ),
        (("--format", "typst", "--width", "wide"), "--width: not a width ('wide')."),
        (
            ("--format", "markdown", "--width", "single"),
            "--width: not with markdown (single). Allowed: --format latex or",
        ),
        (("--width", "single"), "--width: not with the whole table (single)."),
        (("--format", "latex", "--width", "60"), "--width: the table needs "),
    ],
)
def test_a_width_that_no_table_has_is_one_line(cli, sweep, options, message):
    ending = cli("table", sweep, *options)
    assert ending.code == 2
    assert ending.err.startswith(f"runner: {message}")
    assert len(ending.err.splitlines()) == 1


def test_the_whole_table_stays_as_it_was(cli, sweep):
    ending = cli("table", sweep)
    assert re.match(r"2 cells, 0 of them failed, \d with caveats; \d+ columns: table.parquet, table.csv\n", ending.out)
    assert ending.out.splitlines()[-1] == str(sweep)
    assert len(pd.read_csv(sweep / "table.csv")) == 2
