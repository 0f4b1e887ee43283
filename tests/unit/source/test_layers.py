"""Rooms know only those before them: drawings know no report, the vocabulary of reports no audit and no study."""

import ast
from pathlib import Path

import runner.report

import runner.base.quantities
import runner.reporting.charts

FOLDER = Path(runner.reporting.__file__).parent
DRAWING = sorted(Path(runner.reporting.charts.__file__).parent.glob("*.py"))


def imported(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)] + [
        alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names
    ]


def known(paths, *rooms):
    """Return the modules of rooms that files import, with the file."""
    return [f"{path.name}: {name}" for path in paths for name in imported(path) if name.startswith(rooms)]


def test_drawings_and_numbers_as_text_know_no_report():
    assert known([*DRAWING, Path(runner.base.quantities.__file__)], "runner.report", "runner.study") == []


def test_the_vocabulary_knows_nothing_of_the_audit_and_the_studies():
    names = ("document.py", "markup.py", "templating.py", "html.py", "pdf.py", "formulas.py")
    assert known([FOLDER / name for name in names], "runner.audit", "runner.study") == []
