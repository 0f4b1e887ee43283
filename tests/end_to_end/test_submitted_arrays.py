"""The script that `--slurm N` prints, submitted with a substitute for `sbatch`."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from support.patience import PATIENCE

from runner.store import open_sweep

LINE = ("-m", "robot=macro", "plant=rk4", "noise.position=0,1e-3", "seed=range(0,3)", "duration=0.05")
# It executes the tasks one after the other. NO_NODE names a task that gets no node.
SBATCH = """\
#!{python}
import os, re, subprocess, sys

*options, script = sys.argv[1:]
text = open(script).read()
found = dict(re.findall(r"^#SBATCH --([\\w-]+)=?(.*)$", text, re.M)) | dict(each[2:].split("=") for each in options)
ranges = [[int(end) for end in each.split("-")] for each in found["array"].split(",")]
for task in [task for ends in ranges for task in range(ends[0], ends[-1] + 1)]:
    if str(task) != os.environ.get("NO_NODE"):
        own = {{"SLURM_ARRAY_TASK_ID": str(task), "SLURM_CPUS_PER_TASK": found["cpus-per-task"]}}
        subprocess.run(["bash", script], env={{**os.environ, **own}}, check=True)
"""


@pytest.mark.slow  # each task is a process that imports everything; what the script calls is tested on its own
def test_a_job_array_and_the_tasks_that_are_submitted_again_make_the_whole_sweep(cli, tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "sbatch").write_text(SBATCH.format(python=sys.executable))
    (tmp_path / "bin" / "sbatch").chmod(0o755)
    path = os.pathsep.join([str(tmp_path / "bin"), str(Path(sys.executable).parent), os.defpath])

    def shell(command, **variables):
        given = {**os.environ, "PATH": path, **variables}
        return subprocess.run(["bash", "-c", command], env=given, cwd="/", check=True, timeout=PATIENCE)

    script = cli(*LINE, "--slurm", "2", "-j", "1").out
    (tmp_path / "script.sh").write_text(script)
    shell(f"sbatch {tmp_path}/script.sh", NO_NODE="1")
    (folder,) = tmp_path.glob("outputs/sweeps/*")
    assert cli("status", folder, "--parts", "2").out == "1\n"
    (again,) = re.findall(r"^# Tasks to submit again: (.*)SCRIPT$", script, re.M)
    shell(f"{again}{tmp_path}/script.sh")
    assert cli("status", folder, "--parts", "2").out == "\n"
    whole = cli(*LINE, "-j", "1", "-o", "whole").folder
    assert whole.name == folder.name
    pairs = zip(open_sweep(folder).runs(), open_sweep(whole).runs(), strict=True)
    assert all((one.hash, one.metrics) == (other.hash, other.metrics) for one, other in pairs)
