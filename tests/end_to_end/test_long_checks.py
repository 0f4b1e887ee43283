"""The long checks as processes, each as short as it can be: they end well, and print no traceback."""

import re
import subprocess
import sys

import pytest

from runner.base.paths import package_dir

pytestmark = pytest.mark.slow

BRIEF = {
    "agreement": ("tools", "agreement"),
    "answers": ("tools", "answers"),
    "friction_coverage": ("tools", "friction_coverage"),
    "fuzz": ("tools.fuzz", "--cases", "5", "--lines", "2"),
    "kills": ("tools", "kills"),
    "made_up_logs": ("tools", "made_up_logs"),
    "option_walk": ("tools.option_walk", "--engines", "rk4", "--sample", "10"),
    "plain_hydra": ("tools", "plain_hydra"),
    "processors": ("tools", "processors"),
}


@pytest.mark.parametrize("name", BRIEF)
def test_a_long_check_ends_well(name):
    """The mutants are left out: tests/unit/tools has theirs, and even one of them runs many tests."""
    command = [sys.executable, "-m", *BRIEF[name]]
    ending = subprocess.run(command, cwd=package_dir().parent, capture_output=True, text=True, check=False)
    assert "Traceback" not in ending.stderr
    assert ending.returncode == 0, ending.stdout
    assert ending.stdout


def test_every_check_is_run():
    source = (package_dir().parent / "tools" / "__main__.py").read_text()
    assert {*BRIEF, "mutants"} == {*re.findall(r'^    "(\w+)",$', source, re.MULTILINE)}
