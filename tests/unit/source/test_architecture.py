"""docs/architecture.md and its picture against the package: docstrings, contract and imports."""

import re

from support.pages import ROOT
from support.recorded_texts import changes

from tools.docs.architecture import PAGE, PICTURE, layers, page, picture, reduced, summary

PACKAGE = ROOT / "runner"


def test_the_page_and_the_picture_are_up_to_date():
    told = changes("docs/architecture.md", PAGE.read_text().splitlines(), page().splitlines())
    assert not told, told
    assert PICTURE.read_text() == picture(), f"{PICTURE.name} is stale; if meant: make record"


def test_the_ways_from_data_to_a_report_name_files():
    ways = PAGE.read_text().split("## From data to a report")[1].split("## ")[0]
    named = re.findall(r"`(\w+/[\w./]+)`", ways)
    assert len(named) == len(set(named)) > 20
    assert [name for name in named if not (ROOT / name).is_file()] == []


def test_every_package_is_a_layer_and_three_modules_are_loose():
    found = {f"runner.{path.parent.name}" for path in PACKAGE.glob("*/__init__.py")}
    assert found == set(layers()) - {"hydra_plugins", "runner.plugin"}
    assert sorted(path.name for path in PACKAGE.glob("*.py")) == ["__init__.py", "__main__.py", "plugin.py"]


def test_an_edge_that_follows_from_others_is_left_out():
    graph = {"a": {"b", "c", "d"}, "b": {"c"}, "c": set(), "d": set()}
    assert reduced(graph) == {"a": ["b", "d"], "b": ["c"], "c": [], "d": []}


def test_docstrings_of_modules_begin_with_a_noun_phrase():
    """A phrase of one line that ends in a full stop, and no clause without a head."""
    headless = {"What", "How", "Where", "Which", "Whether", "Who", "Why", "When", "Tell", "Return"}
    firsts = {path.relative_to(PACKAGE).as_posix(): summary(path) for path in PACKAGE.rglob("*.py")}
    assert {name: first for name, first in firsts.items() if not first.endswith((".", ":"))} == {}
    assert {name: first for name, first in firsts.items() if first.partition(" ")[0] in headless} == {}
