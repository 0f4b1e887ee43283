"""Scripts that pages show, for Slurm and for GitHub, run with substitutes for the programs of these machines."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from support.pages import ROOT, follow, steps
from support.patience import PATIENCE

DOCS = ROOT / "docs"
STAND_INS = {"srun": 'exec "$@"'}


def scripts(name, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", (DOCS / name).read_text(encoding="utf-8"), re.M | re.S)


def run_script(text, folder, environment):
    """Run a script in a shell that has HOME, PATH, substitutes for Slurm, and the given variables."""
    binaries = folder / "bin"
    binaries.mkdir()
    for name, body in STAND_INS.items():
        (binaries / name).write_text(f"#!/bin/sh\n{body}\n")
        (binaries / name).chmod(0o755)
    path = os.pathsep.join([str(binaries), str(Path(sys.executable).parent), os.defpath])
    given = {"HOME": str(folder), "PATH": path, **environment}
    return subprocess.run(["bash", "-c", text], cwd=folder, env=given, capture_output=True, text=True, timeout=PATIENCE)


# Both scripts start a scheduler or workers, which takes seconds; what they call is tested on its own.
@pytest.mark.slow
@pytest.mark.parametrize(("number", "runs"), [(0, 3), (1, 8)], ids=["array", "scheduler"])
def test_scripts_for_slurm_make_their_runs(tmp_path, number, runs):
    script = [text for text in scripts("sweeps.md", "bash") if "#SBATCH" in text][number]
    for shown, here in (("range(0,10000)", "range(0,9)"), ("100", "3"), ("interface=ib0", "interface=lo")):
        script = script.replace(shown, here)
    ended = run_script(script, tmp_path, {"SLURM_ARRAY_TASK_ID": "1", "SLURM_CPUS_PER_TASK": "2"})
    assert ended.returncode == 0, ended.stderr
    assert len([*(tmp_path / "outputs" / "runs").iterdir()]) == runs


# It makes a sweep twice; what `runner check` does with a baseline is tested on its own.
@pytest.mark.slow
def test_the_workflow_for_github_holds_on_the_same_sweep(tmp_path):
    follow(steps(DOCS / "ci.md", until="1. Save a baseline"), tmp_path)
    (text,) = scripts("ci.md", "yaml")
    step = yaml.safe_load(text)["jobs"]["arm"]["steps"][-1]
    ended = run_script(step["run"], tmp_path / "checkout", {"GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")})
    assert ended.returncode == 0, ended.stderr
    assert "0 beyond the seeds' spread" in (tmp_path / "summary.md").read_text()


def test_the_gallery_builds_the_report_that_it_shows():
    text = (ROOT / "tools" / "docs" / "gallery.py").read_text()
    shown = [
        step.command for step in steps(DOCS / "gallery.md") if "controller=computed_torque,passivity" in step.command
    ]
    (words,) = [command.split()[2:] for command in shown]
    assert all(f'"{word}"' in text for word in words if not word.startswith("controller="))
