"""Scripts of job arrays that `--slurm N` prints, and the parts with missing cells that `status --parts N` prints."""

import re
import shlex
import shutil
import subprocess

import pytest

from runner.store import open_runs, open_sweep
from runner.sweeps.deadline import TimeLimitError
from runner.sweeps.estimate import Estimate
from runner.sweeps.status import in_ranges

LINE = ("robot=macro", "duration=0.05", "noise.position=0,1e-3", "seed=range(0,4)")


def directives(script):
    return dict(re.findall(r"^#SBATCH --([\w-]+)=?(.*)$", script, re.M))


@pytest.mark.parametrize("line", [("-m", *LINE), ("sweep", *LINE, "hydra.sweeper.workers=2")])
def test_a_script_has_an_array_and_the_command_of_every_task(cli, tmp_path, line):
    ending = cli(*line, "--slurm", "3", "-j", "4", "-o", "my out")
    assert ending.code == 0
    found = directives(ending.out)
    assert re.fullmatch(r"\d\d:\d\d:00", found.pop("time"))
    assert found == {"array": "0-2", "cpus-per-task": "4", "requeue": "", "open-mode": "append"}
    folder = next((tmp_path / "my out" / "sweeps").iterdir())
    *_, here, command, last = ending.out.splitlines()
    assert here == f"cd {tmp_path} || exit"
    assert shlex.split(command.rstrip("\\")) == ["runner", "-m", *LINE, "--output=my out"]
    assert last.split() == [
        'sweep.part="$SLURM_ARRAY_TASK_ID/3"',
        'hydra.sweeper.workers="${SLURM_CPUS_PER_TASK:-1}"',
    ]
    assert f"# Progress: runner status '{folder}'" in ending.out
    assert "3 of 3 tasks have missing cells; submit the script with `sbatch`" in ending.err
    assert open_sweep(folder).command == shlex.join(["runner", "-m", *LINE, "--output=my out"])
    assert not [*(tmp_path / "my out").glob("runs/*")]


@pytest.mark.parametrize("name", ["outputs", "my out", "it's", "a$(touch x)\nb"])
def test_a_script_is_clean(cli, tmp_path, monkeypatch, name):
    (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path / name)
    script = tmp_path / "script.sh"
    script.write_text(cli("-m", *LINE, "--slurm", "2", "-o", name).out)
    assert directives(script.read_text())["array"] == "0-1"
    for checker in (["bash", "-n"], ["shellcheck"]):
        if shutil.which(checker[0]):
            checked = subprocess.run([*checker, script], capture_output=True, text=True)
            assert (checked.returncode, checked.stdout, checked.stderr) == (0, "", "")


def test_only_parts_with_missing_cells_are_in_a_script_and_in_the_status(cli):
    cli("-m", *LINE, "sweep.part=1/5", "-j", "1")
    ended = cli("-m", *LINE, "sweep.part=3/5", "-j", "1")
    assert cli("status", ended.folder, "--parts", "5").out == "0,2,4\n"
    assert directives(cli("-m", *LINE, "--slurm", "5").out)["array"] == "0,2,4"
    assert cli("status", "latest", "--parts", "2").out == "0-1\n"
    whole = cli("-m", *LINE, "-j", "1")
    assert (cli("status", whole.folder, "--parts", "5").out) == "\n"
    ending = cli("-m", *LINE, "--slurm", "5")
    assert (ending.code, ending.out) == (0, "")
    assert "all 8 cells are stored; no task is left" in ending.err


@pytest.mark.parametrize(
    ("numbers", "text"),
    [([], ""), ([0], "0"), ([3, 17, 40, 41, 42], "3,17,40-42"), ([0, 1, 3, 4], "0-1,3-4"), (range(100), "0-99")],
)
def test_numbers_in_the_form_of_slurm(numbers, text):
    assert in_ranges(numbers) == text


@pytest.mark.parametrize(
    ("expected", "workers", "time", "message"),
    [
        (Estimate(3600.0), 1, "01:01:00", "this machine's time for the longest task, about 30 min, and a minute"),
        (Estimate(3600.0), 2, "00:31:00", "about 15 min, and a minute"),
        (Estimate(360000.0), 1, "100:01:00", "about 50.0 h"),
        (None, 1, None, "No time limit is set, because an estimate takes too long. Add --time."),
    ],
)
def test_the_time_limit_is_twice_the_estimate_of_the_longest_task(cli, monkeypatch, expected, workers, time, message):
    def estimate(*_):
        if expected is None:
            raise TimeLimitError
        return expected

    monkeypatch.setattr("runner.sweeps.preview.estimate", estimate)
    script = cli("-m", *LINE, "--slurm", "2", "-j", str(workers)).out
    assert directives(script).get("time") == time
    assert message in script


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (("-m", *LINE, "--slurm", "9"), "--slurm: more tasks than cells (9). Allowed: 1 to 8."),
        (("-m", *LINE, "--slurm", "0"), "--slurm: not a count ('0'). Allowed: a whole number, 1 or more."),
        (("robot=macro", "--slurm", "2"), "--slurm: one run needs no job array. Add -m for a sweep."),
        (
            ("-m", *LINE, "--slurm", "2", "--dry-run"),
            "--slurm: simulates nothing, as --dry-run. Leave out one of them.",
        ),
        (("-m", *LINE, "--slurm", "2", "sweep.part=0/2"), "sweep.part: --slurm sets it in each task. Leave it out."),
        (
            ("-m", *LINE, "--slurm", "2", "hydra.sweeper.address=s.json"),
            "--slurm: tasks of an array use no Dask scheduler. Set hydra.sweeper.address=null.",
        ),
        (("-m", *LINE, "seed=0,-1", "--slurm", "2"), "seed: must be 0 or more"),
    ],
)
def test_a_wrong_line_is_refused(cli, tmp_path, line, message):
    ending = cli(*line)
    assert (ending.code, ending.out) == (2, "")
    assert message in ending.err
    assert list(tmp_path.iterdir()) == []


def test_parts_of_what_has_none_are_refused(cli, copy_sweep):
    listed = copy_sweep("goal", "noise")
    assert f"--parts: only a sweep of `runner -m` has parts ({listed})." in cli("status", listed, "--parts", "2").err
    whole = cli("-m", *LINE, "-j", "1").folder
    ending = cli("status", whole, "--parts", "9")
    assert (ending.code, ending.err) == (2, "runner: --parts: more parts than cells (9). Allowed: 1 to 8.\n")


def test_another_grid_in_the_same_folder_is_another_sweep(cli):
    one = cli("-m", *LINE, "sweep.part=0/2", "-j", "1").folder
    other = cli("-m", *LINE[:3], "seed=range(2,6)", "sweep.part=1/2", "-j", "1").folder
    assert one != other
    assert [cli("status", folder, "--parts", "2").out for folder in (one, other)] == ["1\n", "0\n"]
    assert len(open_runs(cli("-m", *LINE, "-j", "1").folder)) == 8
