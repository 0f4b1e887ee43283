"""The examples in docstrings, on the page and in the notebook are run as they stand."""

import doctest
import importlib
import json
import pkgutil
import re
from pathlib import Path

import pytest

import runner
import runner.api

ROOT = Path(__file__).parents[3]
MODULES = sorted(f"runner.api.{found.name}" for found in pkgutil.iter_modules(runner.api.__path__))


@pytest.mark.parametrize("module", ["runner", *MODULES])
def test_docstrings(module, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = importlib.import_module(module)
    failed, _ = doctest.testmod(found, extraglobs={"runner": runner})
    assert failed == 0


def test_all_that_is_called_has_an_example():
    shown = [getattr(runner, name).__doc__ for name in ("run", "sweep", "tune", "calibrate", "report", "open_run")]
    assert all(">>> " in text for text in [*shown, runner.Run.__doc__, runner.Sweep.__doc__])


def test_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs/python.md").read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) > 3
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)


def test_the_notebook(tmp_path, monkeypatch):
    """Cell by cell, in one namespace; what a cell ends with is shown, as a notebook does."""
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((ROOT / "examples/notebook.ipynb").read_text())
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) > 3
    names: dict[str, object] = {}
    for cell in cells:
        *lines, last = cell.strip().splitlines()
        exec("\n".join(lines), names)
        if re.match(r"\w+ = |import ", last):
            exec(last, names)
        else:
            shown = eval(last, names)
            assert shown is not None
            assert any(hasattr(shown, show) for show in ("_repr_html_", "_repr_png_", "__str__"))


def test_the_notebook_has_no_outputs_and_a_known_format():
    notebook = json.loads((ROOT / "examples/notebook.ipynb").read_text())
    assert notebook["nbformat"] == 4
    assert all(cell["outputs"] == [] for cell in notebook["cells"] if cell["cell_type"] == "code")
