"""Output at TAB: words and nothing else, for any typed line."""

import os
import shutil
import subprocess
import sys

import pytest

LINES = (
    "", "r", "robot", "robot=", "robot=macro,", "robot=nosuch ", "robot=nosuch controller.", "controller..", ".", "=",
    "==", "=,", "-", "--", "-m", "-m ", "-m robot=macro,mini", "--nosuch ", "nosuch ", "nosuch --", "report ",
    "report --metrics ", "report nosuch ", "table nosuch --", "status ", "list ", "list nosuch ", "tune ", "tune --min",
    "tune --minimize", "tune --minimize ", "tune --trials x ", "tune --trials", "study ", "study nosuch ", "study new ",
    "study check nosuch --", "check --baseline ", "run a", "sweep ", "reproduce ", "reproduce nosuch ",
    "doctor nosuch ",
    "audit --tip ", "calibrate calibration=", "calibrate nosuch=", "--plugin ", "--plugin nosuch=", "--plugin=",
    "--plugin controller=nosuch.py controller=", "--plugin controller ", "--config-dir ", "--config-dir nosuch robot=",
    "--config-dir bad robot=", "--config-dir bad robot=broken robot.", "--config-dir bad robot=code robot.",
    "--cfg ", "--cfg job controller.", "'", '"robot=m', "robot='", "a[", "a={b:", "controller.period=[1,", "${", "$(x)",
    "hydra.", "hydra.searchpath=[pkg://os] controller.", "hydra/", "+", "~", "++controller.", "~robot", "robot@x=",
    "robot=macro robot.home.", "robot.home.0=", "robot=macro seed=", "é", "\x01", "seed=1e", "x." * 200,
)  # fmt: skip


@pytest.fixture(autouse=True)
def bad_folder(tmp_path):
    robots = tmp_path / "bad" / "robot"
    robots.mkdir(parents=True)
    (robots / "broken.yaml").write_text("a: [1\nb: }")
    (robots / "code.yaml").write_text("# @package _global_\nhydra: {callbacks: {a: {_target_: os.abort}}}\n")


def test_nothing_but_words_is_printed(tab, capfd):
    wrong = []
    for line in LINES:
        words = tab(line)
        out, err = capfd.readouterr()
        last = line.rpartition(" ")[2].replace("'", "").replace('"', "")
        if (out, err) != ("", "") or not all(word.strip("\"'").startswith(last) for word in words):
            wrong.append((line, words, out, err))
    assert wrong == []


def test_a_fault_of_ours_is_no_words(tab, monkeypatch):
    def fail(*_):
        raise KeyError

    monkeypatch.setattr("runner.cli.completion.complete.override_words", fail)
    assert tab("rob") == []


def test_only_words_that_stand_for_configs_import_hydra(tmp_path):
    heavy = "{'hydra', 'omegaconf', 'numpy', 'pydantic', 'yaml', 'importlib.metadata'}"
    for line in ("", "rep", "list ", "robot=m", "experiment=thesis/", "report ", "table --", "tune --min", "study c"):
        lines = (
            "import sys; from runner.cli.completion.complete import complete; complete(sys.stdout, lambda _: None); "
            f"assert not {heavy} & {{*sys.modules}}, {heavy} & {{*sys.modules}}"
        )
        typed = f"runner {line}"
        environment = {**os.environ, "COMP_LINE": typed, "COMP_POINT": str(len(typed)), "_ARGCOMPLETE": "1"}
        subprocess.run([sys.executable, "-c", lines], check=True, stdout=-1, env=environment, cwd=tmp_path)


BASH = """
    PATH="$PWD:$PATH"
    eval "$(runner -sc install=bash)"
    tab() {
        COMP_LINE="$1" COMP_POINT=${#1} COMP_TYPE=9
        COMPREPLY=(); _python_argcomplete runner 2> /dev/null; (IFS=' '; echo "${COMPREPLY[*]}")
    }
"""


@pytest.fixture
def bash(tmp_path):
    """Run lines in bash after the lines that enable completion; `tab LINE` prints the words for it."""
    if shutil.which("bash") is None:
        pytest.skip("needs bash")
    command = tmp_path / "runner"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m runner "$@"\n')
    command.chmod(0o755)

    def run(lines):
        ending = subprocess.run(["bash", "-c", BASH + lines], cwd=tmp_path, capture_output=True, text=True, check=True)
        assert ending.stderr == ""
        return ending.stdout.splitlines()

    return run


def test_the_function_that_is_installed_in_bash(bash):
    lines = """
        tab 'runner rep'; tab 'runner list rob'
        tab 'runner -m robot=macro,mini,xarm7_'; tab 'runner robot=x controller.'
    """
    # Bash completes the part of a word behind a word break such as "=".
    assert [line.strip() for line in bash(lines)] == [
        "repetitions= report reproduce",
        "robots",
        "macro,mini,xarm7_mini",
        "",
    ]


def test_names_that_a_shell_would_carry_out_are_quoted(bash, tmp_path):
    names = ("$(touch gone)", "`touch gone`", "two words", "a;b", "plain", "*")
    for name in names:
        (tmp_path / "outputs" / "runs" / name).mkdir(parents=True)
    (found,) = bash("tab 'runner report outputs/runs/'")
    assert "outputs/runs/plain" in found
    assert not (tmp_path / "gone").exists()
    typed = bash("tab 'runner report outputs/runs/' > found; eval \"printf '%s\\n' $(cat found)\"")
    assert not (tmp_path / "gone").exists()
    assert {f"outputs/runs/{name}" for name in names} <= set(typed)


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_lines_for_each_shell(cli, shell):
    ending = cli("-sc", f"install={shell}")
    assert (ending.code, ending.err) == (0, "")
    assert "_ARGCOMPLETE" in ending.out


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_a_key_that_goes_on_gets_no_space(cli):
    assert cli("-sc", "install=bash").out.count("[=/:.]") == 2


@pytest.mark.parametrize("word", ["install=bsh", "query=bash", "uninstall=bash", ""])
def test_what_cannot_be_installed_is_rejected(cli, word):
    ending = cli("-sc", word)
    assert (ending.code, ending.out) == (2, "")
    assert 'Allowed: install= and one of bash, zsh, fish, as in eval "$(runner -sc install=bash)"' in ending.err
