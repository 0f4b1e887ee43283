"""Mistakes on the command line: each ends with exit code 2 and a line with what is wrong and what is allowed."""

from importlib.metadata import version

import pytest

MISTAKES = [
    ("run --jbos 2", "unrecognized arguments: --jbos (did you mean --jobs?). Usage: runner run"),
    ("report --html x", "--html is now called --format html."),
    ("report RUN --format pfd", "--format: unknown name 'pfd'. Allowed: html, pdf. Did you mean 'pdf'?"),
    ("report RUN --metrics energy", "is not a sweep. Allowed: only for sweeps."),
    ("table RUN --where a=1", "is a run. Allowed: only for sweeps."),
    ("compare RUN RUN --where a=1", "--where: not for these results. Allowed: only for sweeps."),
    ("compare RUN --fill-gaps 20", "--fill-gaps: not a time ('20'). Allowed: a time above 0, such as 20ms."),
    ("compare RUN RUN --output X", "--output: nothing is written (X). Allowed: only with a recording."),
    ("compare RUN r.csv --columns map.yaml --json", "--metrics, --json and --all: not for recordings."),
    ("compare RUN r.csv --columns map.yaml --all", "--metrics, --json and --all: not for recordings."),
    ("check RUN --save-baseline F --baseline MISSING", "--save-baseline compares nothing: not with --baseline, "),
    ("check RUN --save-baseline F --max-failure-probability 0.1", "--save-baseline compares nothing: not with "),
    ("check RUN --save-baseline F --format markdown", "not with --baseline, --max-failure-probability or --format."),
    ("figures RUN --motion m.gif --output DIR", "--output: not with --motion (DIR), which names its own file."),
    ("reproduce audit --profile quick", "--code and --profile: not for the audit, which runs no study. Allowed: "),
    ("sensitivity RUN --parameters gain", "--parameters: unknown name 'gain'. Allowed: gains, masses"),
    ("sensitivity RUN --repetition 9", "has no repetition 9. Allowed: 0 to 0."),
    ("status RUN", "RUN: it is the folder of a run. Allowed: the folder of a sweep"),
    ("check RUN --baseline none.yaml", "cannot read the baseline none.yaml: No such file or directory"),
    ("check RUN --format text,markdown", "--format: too many names (text,markdown). Allowed: at most 1."),
    ("study chek x", "ACTION: unknown name 'chek'. Allowed: new, check, diff. Did you mean 'check'?"),
    (
        "reproduce xarm7 robot=macro",
        "reproduce: the study decides what it simulates (robot=macro). Allowed: hydra.sweeper.*, ",
    ),
    ("list robts", "list: unknown topic 'robts'. Allowed: "),
    ("audit xarm7 --tip link7", "no formulas to compare. Add one of --position, "),
    ("--cfg job -m seed=0,1", "--cfg: prints the config of one run. Leave out -m, and give each key one value."),
    ("sweep seed=0,1 -c job", "--cfg: prints the config of one run. Leave out -m, and give each key one value."),
    ("-c jb", "--cfg: unknown name 'jb'. Allowed: job, hydra, all. Did you mean 'job'?"),
    ("robot=macro -c", "--cfg: unknown name ''. Allowed: job, hydra, all."),
    ("-sc install=bsh", "Allowed: install= and one of bash, zsh, fish"),
]


@pytest.mark.parametrize(("line", "message"), MISTAKES, ids=[line for line, _ in MISTAKES])
def test_a_mistake_is_told_in_a_line(cli, copy_run, line, message):
    run = str(copy_run("goal")) if "RUN" in line else ""
    ending = cli(*(word if word != "RUN" else run for word in line.split()))
    assert (ending.code, ending.out) == (2, "")
    assert message.replace("RUN", run) in ending.err
    assert ending.err.count("\n") == 1


OVERRIDES = [
    ("-m seed=choice(1,2),3", "seed: a function inside a list of values ('choice(1,2),3'). Allowed: one function that"),
    ("-m seed=1,[choice(1,2)]", "seed: a function inside a list of values ('1,[choice(1,2)]'). Allowed: one function"),
    ("-m noise=glob(t*),none", "noise: a function inside a list of values ('glob(t*),none'). Allowed: one function"),
    ("-m seed=interval(0,1)", "seed: an interval has no single values to sweep over (interval(0,1)). Allowed: values"),
    ("-m seed=range(0,1,0)", "seed: the step of a range must not be 0; found range(0,1,0)"),
    ("-m seed=range(0,nan)", "seed: the ends and the step of a range must be finite; found range(0,nan)"),
    ("seed=choice(1,2),3", "'seed=choice(1,2),3' gives several values; `runner -m` sweeps over them"),
    ("seed=range(0,3)", "'seed=range(0,3)' gives several values; `runner -m` sweeps over them"),
]


@pytest.mark.parametrize(("line", "message"), OVERRIDES, ids=[line for line, _ in OVERRIDES])
def test_a_wrong_list_of_values_is_told_in_a_sentence(cli, tmp_path, line, message):
    ending = cli(*line.split())
    assert (ending.code, ending.out) == (2, "")
    assert ending.err.startswith(f"runner: 1 problem in the config:\n  - {message}")
    assert list(tmp_path.iterdir()) == []


def test_flags_of_hydra_have_their_values(cli, tmp_path):
    (tmp_path / "job").mkdir()  # not a config folder here
    assert (
        cli("-c", "job", "robot=mini").out == cli("--cfg", "job", "robot=mini").out == cli("-c=job", "robot=mini").out
    )
    assert "workers: 2" in cli("--cfg", "hydra", "-p", "hydra.sweeper").out


@pytest.mark.parametrize("line", ["--version", "run --version", "sweep --version", "robot=macro --version"])
def test_the_version_is_that_of_the_runner(cli, line):
    assert cli(*line.split()).out == f"{version('arm-control-runner')}\n"
