"""Pages and messages promise neither a computing time that no tool measures nor a package that no registry has."""

import re

import pytest
from support.pages import ROOT, pages

from runner.base.paths import package_dir

TIME = re.compile(
    r"\(\d+ minutes\)|\bin (?:\d+|some|a few|ten) (?:minutes|seconds)\b|\b\d+ ?m?s of CPU\b"
    r"|\btakes? (?:less time|about \w+ (?:seconds|minutes|hours))|\bfor some seconds\b",
    re.I,
)
OF_REGISTRY = re.compile(r"pip install [^`\n]*\barm-control-runner\b")
EXAMPLES = [path for path in (ROOT / "examples").rglob("*") if path.suffix in (".md", ".sh", ".yml", ".py")]
SOURCES = sorted(package_dir().rglob("*.py"))


def test_no_page_or_help_promises_a_computing_time():
    texts = {path.name: path.read_text(encoding="utf-8") for path in (*pages(), *(package_dir() / "cli").rglob("*.py"))}
    assert {name: found for name, text in texts.items() if (found := TIME.findall(text))} == {}


def test_nothing_installs_the_package_by_a_name():
    texts = {path: path.read_text(encoding="utf-8") for path in (*pages(), *EXAMPLES, *SOURCES)}
    assert [str(path) for path, text in texts.items() if OF_REGISTRY.search(text)] == []


@pytest.mark.parametrize(
    ("pattern", "text", "found"),
    [
        (TIME, "## 1. Install (2 minutes)", True),
        (TIME, "In 20 minutes you will", True),
        (TIME, "each takes about 0.5 ms of CPU", True),
        (TIME, "`check` takes about ten seconds", True),
        (TIME, "a worker that is still stuck 10 s later", False),
        (OF_REGISTRY, "`pip install 'arm-control-runner[ros]'`", True),
        (OF_REGISTRY, "`pip install 'WHEEL[ros]'`; arm-control-runner", False),
    ],
)
def test_the_patterns_find_promises_and_nothing_else(pattern, text, found):
    assert bool(pattern.search(text)) is found
