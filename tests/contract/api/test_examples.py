"""Examples in docstrings of the public functions and in the notebook, run unchanged."""

import doctest
import importlib
import json
import pkgutil
import re

import pytest
from support.pages import ROOT

import runner
import runner.api

MODULES = sorted(f"runner.api.{found.name}" for found in pkgutil.iter_modules(runner.api.__path__))


@pytest.mark.costs(3)
def test_docstrings(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    modules = [runner, *map(importlib.import_module, MODULES)]
    tried = {found.__name__: doctest.testmod(found, extraglobs={"runner": runner}) for found in modules}
    assert [name for name, outcome in tried.items() if outcome.failed] == []


def test_all_that_is_called_has_an_example():
    shown = [
        getattr(runner, name).__doc__
        for name in ("run", "sweep", "tune", "calibrate", "report", "compare", "open_run", "open_tuning")
    ]
    assert all(">>> " in text for text in [*shown, runner.Run.__doc__, runner.Sweep.__doc__])


@pytest.mark.usefixtures("no_processes")
def test_the_notebook(tmp_path, monkeypatch):
    """Run cell by cell, in one namespace. Show the last value of a cell like a notebook."""
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
