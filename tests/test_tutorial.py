"""docs/tutorial.md, followed command by command in one shell."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
COMMANDS = re.findall(r"^    \$ (.*)$", (ROOT / "docs" / "tutorial.md").read_text(), re.M)
INSTALL = 3  # commands that install and choose a folder; the test stands in for them
FINDINGS = 1  # exit code of `runner doctor` where there is something to mend


@pytest.mark.slow
def test_every_command_does_what_the_tutorial_says(tmp_path):
    binaries = tmp_path / "bin"
    binaries.mkdir()
    for name, words in (("python", ""), ("runner", "-m runner")):
        (binaries / name).write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} {words} "$@"\n')
        (binaries / name).chmod(0o755)
    lines = ["set -e"]
    for command in COMMANDS[INSTALL:]:
        allowed = f" || [ $? -eq {FINDINGS} ]" if command.startswith("runner doctor") else ""
        lines.append(command + allowed)
    ending = subprocess.run(
        ["/bin/sh", "-c", "\n".join(lines)],
        cwd=tmp_path,
        env={
            **os.environ,
            "PATH": f"{binaries}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": str(ROOT),
            "EXAMPLE": str(ROOT / "examples" / "own_robot"),
        },
        capture_output=True,
        text=True,
    )
    assert ending.returncode == 0, ending.stderr
    assert ending.stdout.splitlines()[-1].startswith("good: 1 metrics of 1 run")
    assert len(list((tmp_path / "outputs/runs").iterdir())) == 2 + 16
    assert len(list((tmp_path / "outputs/reports").glob("*/report.pdf"))) == 2
    assert len((tmp_path / "mine/robot/lbr_iiwa.yaml").read_text().splitlines()) <= 15
