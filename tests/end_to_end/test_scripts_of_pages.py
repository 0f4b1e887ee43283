"""The pages on troubles, CI, clusters and the gallery, followed command by command."""

import os
import re
import socket
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from support.pages import ROOT, follow, is_shown, steps

DOCS = ROOT / "docs"
FAILED, BAD_INPUT = 1, 2


def follow_page(name, folder):
    ended = follow(steps(DOCS / name), folder, {})
    assert ended
    for one in ended:
        assert is_shown(one), one
    return {one.step.command: one for one in ended}


def scripts(name, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", (DOCS / name).read_text(), re.M | re.S)


def test_troubles_end_as_the_page_says(tmp_path):
    for command, one in follow_page("troubleshooting.md", tmp_path).items():
        refused = "problem in the config" in one.printed or command.startswith("runner report")
        failed = "runner: failed in repetition" in one.printed
        assert one.code == (BAD_INPUT if refused else FAILED if failed else 0), one


def test_parts_of_a_sweep_make_the_whole(tmp_path):
    assert all(one.code == 0 for one in follow_page("cluster.md", tmp_path).values())
    assert len([*(tmp_path / "shared/outputs/runs").iterdir()]) == 8


@pytest.mark.slow
def test_the_check_of_the_workflow_holds_and_falls_short(tmp_path):
    *_, worse = follow_page("ci.md", tmp_path).values()
    assert worse.code == FAILED
    (text,) = scripts("ci.md", "yaml")
    step = yaml.safe_load(text)["jobs"]["arm"]["steps"][-1]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")}
    environment["PATH"] = f"{tmp_path / '.bin'}{os.pathsep}{environment['PATH']}"
    ended = subprocess.run(["bash", "-c", step["run"]], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert "0 beyond the seeds' spread" in (tmp_path / "summary.md").read_text()


@pytest.mark.slow
@pytest.mark.parametrize("script", scripts("cluster.md", "bash"), ids=["array", "scheduler"])
def test_scripts_for_slurm_run_in_its_place(tmp_path, script):
    binaries = tmp_path / "bin"
    binaries.mkdir()
    stubs = {"srun": 'exec "$@"', "hostname": "echo 127.0.0.1", "runner": f'exec {sys.executable} -m runner "$@"'}
    for name, body in stubs.items():
        (binaries / name).write_text(f"#!/bin/sh\n{body}\n")
        (binaries / name).chmod(0o755)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    (tmp_path / "job.sh").write_text(script.replace("8786", str(port)).replace("100", "3"))
    environment = {
        **os.environ,
        "PATH": os.pathsep.join([str(binaries), str(Path(sys.executable).parent), os.environ["PATH"]]),
        "PYTHONPATH": str(ROOT),
        "SLURM_ARRAY_TASK_ID": "1",
        "SLURM_CPUS_PER_TASK": "2",
        "HOME": str(tmp_path),
    }
    ended = subprocess.run(["bash", "job.sh"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert len([*(tmp_path / "outputs" / "runs").iterdir()]) == (8 if "dask" in script else 3)


@pytest.mark.slow
def test_the_gallery_shows_commands_that_run(tmp_path):
    few = [step for step in steps(DOCS / "gallery.md") if "reproduce" not in step.command]
    for one in follow(few, tmp_path, {}):
        assert one.code == 0, one


def test_the_gallery_builds_the_report_that_it_shows():
    text = (ROOT / "bench" / "gallery.py").read_text()
    shown = [
        step.command for step in steps(DOCS / "gallery.md") if "controller=computed_torque,passivity" in step.command
    ]
    (words,) = [command.split()[2:] for command in shown]
    assert all(f'"{word}"' in text for word in words if not word.startswith("controller="))
