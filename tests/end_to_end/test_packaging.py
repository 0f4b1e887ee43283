"""The wheel contains every file that a run needs, and works outside of the checkout."""

import subprocess
import sys
import tarfile
import zipfile

import pytest
from support.pages import ROOT
from support.printed import without_caveats, without_results

from runner.store.baselines import baseline_path, shipped_baselines

SCRIPT = """\
import sys
from pathlib import Path
import runner
from runner.cli.main import dispatch
from runner.base.paths import conf_dir, robots_dir, templates_dir
from runner.config.compose.files import group_options
site = Path(sys.prefix)
for folder in (Path(runner.__file__).parent, conf_dir(), robots_dir(), templates_dir()):
    assert folder.is_relative_to(site), folder
assert (Path(runner.__file__).parent / "py.typed").is_file()
assert (templates_dir() / "report.html.j2").is_file()
assert "thesis/figure_3_5" in group_options("experiment")
assert dispatch(["list", "baselines"]) == 0
assert dispatch(["list", "claims"]) == 0
sys.exit(dispatch(["robot=macro", "duration=0.05"]))
"""


def test_the_wheel_holds_configs_robots_templates_and_references(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    for folder in ("conf", "robots", "reports/templates", "examples"):
        ours = {path.relative_to(ROOT).as_posix() for path in (ROOT / folder).rglob("*.*") if path.suffix != ".pyc"}
        assert {f"runner/_data/{name}" for name in ours} <= names
    assert {baseline_path(name).relative_to(ROOT).as_posix() for name in shipped_baselines()} <= names
    assert not [name for name in names if name.startswith(("tests", "bench", "tools", "outputs"))]


def test_the_source_distribution_holds_docs_examples_and_what_builds_the_site(tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-d", tmp_path]
    subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with tarfile.open(next(tmp_path.glob("*.tar.gz"))) as packed:
        names = {name.partition("/")[2] for name in packed.getnames()}
    pages = {path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.*")}
    examples = {path.relative_to(ROOT).as_posix() for path in (ROOT / "examples").rglob("*.*") if path.suffix != ".pyc"}
    assert pages | examples | {"mkdocs.yml", "tools/docs/site_pages.py", "CITATION.cff", "SECURITY.md"} <= names
    assert not [name for name in names if name.startswith(("outputs", "build/", ".venv"))]


@pytest.mark.costs(2)
def test_the_wheel_runs_away_from_the_checkout(installed, tmp_path):
    ending = installed.call(tmp_path, "python", "-c", SCRIPT)
    assert (ending.returncode, without_caveats(without_results(ending.stderr))) == (0, "")
    folder = tmp_path / ending.stdout.splitlines()[-1]
    assert (folder / "metrics.json").is_file()
    assert [entry.name for entry in tmp_path.iterdir()] == ["outputs"]
