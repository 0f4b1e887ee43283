"""Phrases that read as translated: their number in each folder may fall, not rise."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PHRASES = (
    r"in place of",
    r"is no (?:longer )?\w+",
    r"of which",
    r"which is why",
    r"so many",
    r"beside",
    r"alone",
    r"told",
    r"worked out",
    r"mended",
    r"sprung",
    r"held against",
    r"stands? for itself",
    r"is to be had",
    r"as it (?:is|stands)",
    r"likewise",
    r"of its own",
    r"of one's own",
    r"by itself",
    r"Returns? what",
    r"Returns? how",
    r"Tell whether",
    r"behind it",
    r"somebody",
    r"nobody",
)
_PHRASE = re.compile("|".join(rf"\b{phrase}\b" for phrase in PHRASES))
MOST = {
    "README.md": 0,
    "CONTRIBUTING.md": 0,
    "SECURITY.md": 0,
    "CHANGELOG.md": 0,
    "docs": 13,
    "conf": 2,
    "bench": 10,
    "tools": 31,
    "tests": 642,
    "runner/base": 38,
    "runner/cli": 7,
    "runner/config": 26,
    "runner/reporting": 164,
    "runner/robots": 42,
    "runner/studies": 184,
    "runner/study": 84,
}
REST = 164
"""Phrases in all other packages of the runner."""


def count(path: Path) -> int:
    """Return the number of phrases in a file, or in all files of a folder."""
    files = [path] if path.is_file() else [
        file for kind in ("py", "md", "yaml") for file in path.rglob(f"*.{kind}") if file != Path(__file__)
    ]  # fmt: skip
    return sum(len(_PHRASE.findall(file.read_text(encoding="utf-8"))) for file in files)


@pytest.mark.parametrize(("name", "most"), MOST.items())
def test_phrases_do_not_spread(name, most):
    assert count(ROOT / name) <= most


def test_phrases_do_not_spread_in_other_packages():
    others = [path for path in (ROOT / "runner").iterdir() if path.is_dir() and f"runner/{path.name}" not in MOST]
    assert sum(map(count, others)) <= REST


def test_the_list_finds_what_it_names():
    assert _PHRASE.findall("In words: what is told beside it, in place of that") == ["told", "beside", "in place of"]
    assert _PHRASE.findall("The runner simulates every combination.") == []
