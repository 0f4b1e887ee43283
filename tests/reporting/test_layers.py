"""Rooms know only those before them: drawings know no report, the vocabulary of reports no audit and no work."""

import ast
from pathlib import Path

import pytest

import runner.drawing
import runner.quantities
import runner.reporting

FOLDER = Path(runner.reporting.__file__).parent
DRAWING = sorted(Path(runner.drawing.__file__).parent.glob("*.py"))


def imported(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)] + [
        alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names
    ]


@pytest.mark.parametrize("path", [*DRAWING, Path(runner.quantities.__file__)], ids=lambda path: path.stem)
def test_drawings_and_numbers_as_text_know_no_report(path):
    assert [name for name in imported(path) if name.startswith(("runner.reporting", "runner.works"))] == []


@pytest.mark.parametrize("module", ["document.py", "markup.py", "templating.py", "html.py", "pdf.py", "formulas.py"])
def test_the_vocabulary_knows_nothing_of_the_audit_and_the_works(module):
    assert [name for name in imported(FOLDER / module) if name.startswith(("runner.audit", "runner.works"))] == []
