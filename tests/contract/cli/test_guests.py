"""Commands of guests: those of an installed package, and this package without runner/papers."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from runner.base.former_names import MODULES
from runner.cli import commands

CHECKOUT = Path(__file__).parents[3]
GREET = '''\
"""Greet a person.

Example: runner greet Ada
"""

from pathlib import Path


def add_arguments(parser):
    parser.add_argument("person")


def run(options):
    print(f"hello {options.person}")
    return 0


def find_document(path):
    return (lambda: ("a document", path)) if path.name == "greeting" else None


TOPICS = {"greetings": lambda _: {"hello": "A greeting."}}
'''
WITHOUT = """\
import sys
from runner.cli.main import dispatch
for words in (
    ["run", "robot=macro", "duration=0.05"],
    ["sweep", "robot=macro", "duration=0.05", "controller=computed_torque,operational_space", "noise=thesis"],
    ["compare", "latest", "--by", "controller"],
    ["report", "latest"],
    ["figures", "latest"],
    ["results"],
    ["list"],
    ["--help"],
):
    code = dispatch(words)
    assert code == 0, (words, code)
assert dispatch(["reproduce", "thesis"]) == 2
assert not [name for name in sys.modules if name.startswith("runner.papers")]
"""


@pytest.fixture
def greeter(tmp_path, monkeypatch):
    """An installed package with a command."""
    for name, text in (
        ("greeter.py", GREET),
        ("greeter-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: greeter\nVersion: 1.0\n"),
        ("greeter-1.0.dist-info/entry_points.txt", "[runner.command]\ngreet = greeter\n"),
    ):
        (tmp_path / "site" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "site" / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path / "site")
    yield
    sys.modules.pop("greeter", None)


@pytest.mark.usefixtures("greeter")
def test_an_installed_package_adds_a_command_a_topic_and_figures(cli):
    assert cli("greet", "Ada").out == "hello Ada\n"
    assert "Usage: runner greet person" in cli("greet").err
    assert "  greet        Greet a person." in cli("--help").out.splitlines()
    assert "greet" in cli("gret").err
    assert cli("list", "greetings").out == "hello  A greeting.\n"
    compose = commands.find_document(Path("greeting"))
    assert compose is not None
    assert compose() == ("a document", Path("greeting"))
    assert commands.find_document(Path("else")) is None


@pytest.mark.usefixtures("greeter")
def test_a_command_that_cannot_be_imported_is_named_with_its_line(cli, tmp_path):
    (tmp_path / "site" / "greeter.py").write_text('"""Greet a person."""\n\nimport nowhere\n')
    ending = cli("greet", "Ada")
    assert ending.code == 2
    assert "command greet: module greeter cannot be imported" in ending.err
    assert "greeter.py, line 3" in ending.err


def test_the_commands_of_papers_need_no_metadata(monkeypatch):
    monkeypatch.setattr(commands, "entry_points_of", lambda _: pytest.fail("metadata is read"))
    assert commands.groups()["Papers"] == ("audit", "benchmark", "reproduce", "study")
    assert commands.module_of("reproduce") == "runner.papers.commands.reproduce"


@pytest.mark.costs(15)
def test_the_rest_works_without_papers(tmp_path):
    """The folder and the entry points are taken away."""
    skipped = shutil.ignore_patterns("papers")
    shutil.copytree(CHECKOUT / "runner", tmp_path / "runner", ignore=skipped)
    for folder in ("conf", "robots", "reports", "examples", "hydra_plugins"):
        shutil.copytree(CHECKOUT / folder, tmp_path / folder)
    info = tmp_path / "arm_control_runner-0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: arm-control-runner\nVersion: 0\n")
    place = {"PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
    ending = subprocess.run(
        [sys.executable, "-c", WITHOUT], cwd=tmp_path, env=os.environ | place, capture_output=True, text=True
    )
    assert ending.returncode == 0, ending.stderr
    assert "Papers" not in ending.stdout
    assert "three_joint" not in ending.stdout
    assert "unknown command 'reproduce'" in ending.stderr


@pytest.mark.usefixtures("greeter")
def test_a_command_with_a_former_import_is_told_the_present_name(cli, tmp_path):
    (tmp_path / "site" / "greeter.py").write_text(
        '"""Greet a person."""\n\nfrom runner.study.names import study_names\n'
    )
    ending = cli("greet", "Ada")
    assert ending.code == 2
    assert "cannot be imported: runner.study is now called runner.papers.study." in ending.err


@pytest.mark.parametrize(("former", "present"), MODULES.items())
def test_each_present_module_exists(former, present):
    assert importlib.util.find_spec(present) is not None
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module(former)
