"""Answers to a shell at TAB: words alone, for any typed line."""

import os
import shutil
import subprocess
import sys

import pytest

from runner.cli.completion import answer, is_asked

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


def tab(line, monkeypatch, arguments=("-sc", "query=bash")):
    from runner.cli.main import dispatch

    monkeypatch.setenv("COMP_LINE", f"runner {line}")
    return dispatch(arguments)


@pytest.fixture(autouse=True)
def own_place(tmp_path, tmp_path_factory, monkeypatch):
    monkeypatch.chdir(tmp_path)
    place = tmp_path_factory.mktemp("cache")
    monkeypatch.setattr("runner.symbolic.cache.folder", lambda: place)
    robots = tmp_path / "bad" / "robot"
    robots.mkdir(parents=True)
    (robots / "broken.yaml").write_text("a: [1\nb: }")
    (robots / "code.yaml").write_text("# @package _global_\nhydra: {callbacks: {a: {_target_: os.abort}}}\n")


def test_nothing_but_words_is_printed(monkeypatch, capfd):
    wrong = []
    for line in LINES:
        code = tab(line, monkeypatch)
        out, err = capfd.readouterr()
        last = line.rpartition(" ")[2]
        if (code, err, out.count("\n")) != (0, "", 1) or not all(word.startswith(last) for word in out.split()):
            wrong.append((line, code, out, err))
    assert wrong == []


def test_names_that_a_shell_would_carry_out_are_left_out(tmp_path, monkeypatch, capsys):
    for name in ("$(touch gone)", "`touch gone`", "two words", "a;b", "plain"):
        (tmp_path / "outputs" / "runs" / name).mkdir(parents=True)
    tab("report outputs/runs/", monkeypatch)
    assert capsys.readouterr().out.split() == ["outputs/runs/plain", "outputs/runs/plain/"]


def test_fish_takes_a_word_a_line(monkeypatch, capsys):
    tab("list rob", monkeypatch, ("-sc", "query=fish"))
    assert capsys.readouterr().out == "robots\n"
    tab("list p", monkeypatch, ("-sc", "query=fish"))
    assert capsys.readouterr().out == "plants\npresets\n"


def test_a_fault_of_ours_is_no_words(monkeypatch, capfd):
    def fail(_):
        print("out")
        print("err", file=sys.stderr)
        raise KeyError

    monkeypatch.setattr("runner.cli.completion.complete.complete", fail)
    assert tab("rob", monkeypatch) == 0
    assert capfd.readouterr() == ("\n", "")


def test_only_a_query_is_answered():
    assert is_asked(["-sc", "query=bash"])
    assert is_asked(["--shell-completion", "query=zsh"])
    assert not is_asked(["-sc", "install=bash"])
    assert not is_asked(["query=bash"])


def test_only_words_that_stand_for_configs_import_hydra(tmp_path):
    heavy = "{'hydra', 'omegaconf', 'numpy', 'pydantic', 'yaml', 'importlib.metadata'}"
    for line in ("", "rep", "list ", "robot=m", "experiment=thesis/", "report ", "table --", "tune --min", "study c"):
        lines = (
            f"import sys; from runner.cli.main import dispatch; dispatch(['-sc', 'query=bash']); "
            f"assert not {heavy} & {{*sys.modules}}, {heavy} & {{*sys.modules}}"
        )
        environment = {**os.environ, "COMP_LINE": f"runner {line}"}
        subprocess.run([sys.executable, "-c", lines], check=True, stdout=-1, env=environment, cwd=tmp_path)


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_the_function_that_is_installed_in_bash(tmp_path):
    command = tmp_path / "runner"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m runner "$@"\n')
    command.chmod(0o755)
    script = """
        PATH="$PWD:$PATH"
        eval "$(runner -sc install=bash)"
        tab() {
            COMP_LINE="$1" COMP_POINT=${#1}
            COMP_WORDS=($1); [ "${1: -1}" = " " ] && COMP_WORDS+=("")
            COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
            COMPREPLY=(); hydra_bash_completion; echo "${COMPREPLY[@]}"
        }
        tab 'runner rep'; tab 'runner list rob'
        tab 'runner -m robot=macro,mini,xarm7_'; tab 'runner robot=x controller.'
    """
    ending = subprocess.run(["bash", "-c", script], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert ending.stderr == ""
    assert ending.stdout.splitlines() == ["repetitions= report reproduce", "robots", "robot=macro,mini,xarm7_mini", ""]


def test_without_a_shell_it_says_how_to_install_it():
    with pytest.raises(Exception, match="install=bash"):
        answer(["-sc", "query=bash"], {})
