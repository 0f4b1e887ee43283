"""runner.plugin: its names and their description, and the only way in which pages and examples import the package."""

import re
import subprocess
import sys

from support.pages import ROOT

import runner.plugin

PAGES = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
EXAMPLES = [path for path in (ROOT / "examples").rglob("*") if path.suffix in (".ipynb", ".md", ".py", ".sh")]
ON_PAPERS = ("paper.md", "own_paper")
_IMPORT = re.compile(r"(?:^|[\s\"'>;])(?:from (runner[\w.]*) import|import (runner[\w.]*))", re.MULTILINE)


def internal(text, on_papers=False):
    """Return the modules that a text imports from the package, without those for users."""
    found = ("".join(names) for names in _IMPORT.findall(text))
    public = ("runner", "runner.plugin")
    return [name for name in found if name not in public and not (on_papers and name.startswith("runner.papers"))]


def test_pages_and_examples_import_only_the_face():
    found = {
        str(path.relative_to(ROOT)): names
        for path in (*PAGES, *EXAMPLES)
        if (names := internal(path.read_text(encoding="utf-8"), any(part in path.parts for part in ON_PAPERS)))
    }
    assert found == {}


def test_other_imports_are_found():
    text = "    $ python -c 'import runner.store'\n>>> from runner.schema.model import StrictModel\n\"import runner\"\n"
    assert internal(text) == ["runner.store", "runner.schema.model"]
    assert internal("from runner.papers.study import x") == ["runner.papers.study"]
    assert internal("from runner.papers.study import x", on_papers=True) == []


def test_each_name_is_described_and_sorted():
    names = runner.plugin.__all__
    assert names == sorted(names)
    assert all(hasattr(runner.plugin, name) for name in names)
    described = set(re.findall(r"`(\w+)", runner.plugin.__doc__))
    assert set(names) - described == set()
    assert {name for name in described - set(names) if name[0].isupper()} == {"CONFIG"}


def test_the_face_needs_no_engine_and_no_hydra():
    script = (
        "import sys, runner.plugin; "
        "print({'hydra', 'matplotlib', 'mujoco', 'pandas', 'pinocchio', 'scipy', 'typst'} & {*sys.modules})"
    )
    ended = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    assert ended.stdout == "set()\n"
