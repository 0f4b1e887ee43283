"""The API package is above all others, and third-party tools understand it."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import runner

PACKAGE = Path(runner.__file__).parent
TYPED = """\
from pathlib import Path

import runner

run = runner.run("noise=thesis", robot="macro", duration=0.1, config_dirs=Path("mine"))
median: float | None = run.metrics["peak_torque"].median
rows: int = len(run.trace(repetition=1))
sweep = runner.sweep(robot=["macro", "mini"], workers=0)
folder: Path = sweep.folder
best: runner.Run = sweep.run(robot="macro")
page: Path | None = runner.report([run, best], formats="html").html
reveal_type(run.plot("error"))
wrong: int = run.status
runner.run(config_dirs=3)
"""
COMPLETED = """\
import rlcompleter, runner
completer = rlcompleter.Completer({"runner": runner})
found, k = [], 0
while (text := completer.complete("runner.", k)) is not None:
    found.append(text.removeprefix("runner.").rstrip("()"))
    k += 1
print(sorted(found) == sorted(runner.__all__), found)
"""


def test_no_other_room_knows_this_one():
    others = [path for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE / "api" and path.parent != PACKAGE]
    for path in others:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        named = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        named += [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
        assert not [name for name in named if name.startswith("runner.api")], path


def test_tab_shows_what_is_for_users():
    script = "import runner.store, runner.sweeps\n" + COMPLETED
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert found.stdout.startswith("True "), found.stdout


@pytest.mark.slow
def test_types_of_a_strangers_script(tmp_path):
    (tmp_path / "mine.py").write_text(TYPED)
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--no-error-summary",
        "--cache-dir",
        tmp_path / "cache",
        "mine.py",
    ]
    environment = {**os.environ, "MYPYPATH": "", "PYTHONPATH": str(PACKAGE.parent)}
    ending = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    told = [line for line in ending.stdout.splitlines() if line.startswith("mine.py")]
    assert len(told) == 3, ending.stdout
    assert 'Revealed type is "matplotlib.figure.Figure"' in told[0]
    assert "Incompatible types in assignment" in told[1]
    assert 'Argument "config_dirs"' in told[2]
