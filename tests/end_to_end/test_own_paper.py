"""The example of a work in a folder, made by the wheel; and the page of the docs that shows it."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
EXAMPLE = ROOT / "examples" / "own_paper"


@pytest.fixture(scope="module")
def environment(wheel, tmp_path_factory):
    site = tmp_path_factory.mktemp("paper") / "site"
    zipfile.ZipFile(wheel).extractall(site)
    return {**os.environ, "PYTHONPATH": str(site)}


def call(environment, folder, *arguments):
    command = (sys.executable, "-m", "runner", *arguments)
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_the_work_that_the_wheel_writes_is_the_example_and_stands(environment, tmp_path):
    assert call(environment, tmp_path, "work", "new", "mine").returncode == 0
    for path in EXAMPLE.iterdir():
        assert (tmp_path / "mine" / path.name).read_bytes() == path.read_bytes()
    ending = call(environment, tmp_path, "reproduce", "mine", "--check")
    assert (ending.returncode, ending.stdout) == (0, "outputs/reports/mine\n"), ending.stderr
    page = (tmp_path / "outputs" / "reports" / "mine" / "report.html").read_text()
    assert "Half the natural frequency more than doubles the settling time" in page
    assert "runner --config-dir mine robot=macro" in page


def test_the_page_of_the_docs_shows_the_example():
    page = (ROOT / "docs" / "paper.md").read_text()
    shown = re.findall(r"^```(?:yaml|markdown)\n(.*?)^```$", page, re.M | re.S)
    assert sorted(shown) == sorted(path.read_text() for path in EXAMPLE.iterdir())
