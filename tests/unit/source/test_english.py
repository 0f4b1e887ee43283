"""Phrases that read as translated: no line of prose has one, except where a context allows it for a reason."""

import re
from pathlib import Path

import pytest
from support.pages import ROOT
from support.prose import prose

BETTER = {
    r"in place of": "instead of",
    r"is (?<!there is )no (?!longer|more|such|other|need|way|smaller|larger)\w+": "is not a",
    r"of which (?:is|are|has|have|each|one|some|none|the|nobody|somebody)": "whose; or two sentences",
    r"which is why": "so; therefore",
    r"so many": "this many, or the name of the number",
    r"beside": "next to; besides; in addition to",
    r"alone": "only, before its word",
    r"told(?! apart)": "reported; shown; printed; stated",
    r"worked out": "computed",
    r"mend(?:s|ed|ing)?": "fix; correct",
    r"sprung": "triggered",
    r"held against": "compared with",
    r"stands? for itself": "represents itself",
    r"is to be had": "is available",
    r"as it stands": "as printed; unchanged",
    r"as it is": "unchanged; or as, before the participle",
    r"likewise": "also",
    r"of (?:its|one's) own": "its own; a separate; a user's",
    r"[Rr]eturns? (?:what|how)": "Return and a noun",
    r"[Tt]ell whether": "Return True if",
    r"behind it": "that it uses; after it",
    r"(?:some|no)body": "the person: a user, a reader; no process, no test",
}
"""Patterns of phrases, and better words."""
ALLOWED = {
    r"(?:Macro|Mini)\"? alone": "the thesis' name of an arm without the other one",
    r"(?:angles|columns|inverse) alone": "names of runs of the study xarm7",
    r"it moves alone": "quoted from the thesis",
}
"""Patterns of contexts in which a phrase stays, and reasons."""
TOP = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md")
FOLDERS = ("docs", "conf", "bench", "tools", "tests", "examples", "findings", "runner", "hydra_plugins")
GENERATED = ("docs/reference.md", "docs/architecture.md")
_PHRASE = re.compile("|".join(rf"\b{phrase}\b" for phrase in BETTER))


def offences(file: Path):
    """Yield place, phrase and better words for each phrase in the prose of a file."""
    for number, line in prose(file) if _PHRASE.search(file.read_text(encoding="utf-8")) else ():
        for found in _PHRASE.finditer(re.sub("|".join(ALLOWED), "…", line)):
            better = next(words for phrase, words in BETTER.items() if re.match(phrase, found[0]))
            name = file.relative_to(ROOT) if file.is_relative_to(ROOT) else file.name
            yield f"{name}:{number}: '{found[0]}': write {better}"


def files(folder: str):
    """Return the sources with prose in a folder, without this list and generated pages."""
    found = [path for kind in ("py", "md", "yaml") for path in sorted((ROOT / folder).rglob(f"*.{kind}"))]
    return [path for path in found if path != Path(__file__) and str(path.relative_to(ROOT)) not in GENERATED]


@pytest.mark.costs(2)
@pytest.mark.parametrize("place", [*TOP, *FOLDERS])
def test_no_line_reads_as_translated(place):
    found = [each for file in ([ROOT / place] if place in TOP else files(place)) for each in offences(file)]
    assert not found, "\n".join(["reword, or add the context with its reason to ALLOWED:", *found])


@pytest.mark.parametrize("context", ALLOWED)
def test_every_allowed_context_is_used(context):
    sources = (path.read_text(encoding="utf-8") for folder in FOLDERS for path in files(folder))
    assert any(re.search(context, text) for text in sources)


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("a.md", "One.\nIt is told\nof the Macro alone.", ["a.md:2: 'told': write reported; shown; printed; stated"]),
        ("a.md", "`told` is {{ told(x) }} in\n```\ntold\n```\nholds: told > 1\n", []),
        ("a.py", 'told = f"{told} and more"  # it is told apart\n', []),
        ("a.py", 'x = 1\ny = """A sentence.\n\nOf one alone."""', ["a.py:4: 'alone': write only, before its word"]),
        ("a.py", '"""Show it.\n\n    told: It is `told`.\n    """', []),
        (
            "a.py",
            "# beside\nx = 1  # the row beside it\n",
            ["a.py:2: 'beside': write next to; besides; in addition to"],
        ),
        ("a.yaml", "alone: 1 # of which one is\n", ["a.yaml:1: 'of which one': write whose; or two sentences"]),
        ("a.py", 'x = "there is no run; it is no longer a run"', []),
        ("a.py", 'x = "it is no run"', ["a.py:1: 'is no run': write is not a"]),
    ],
)
def test_a_phrase_is_found_with_its_line_and_not_in_code(tmp_path, name, text, found):
    (tmp_path / name).write_text(text, encoding="utf-8")
    assert [*offences(tmp_path / name)] == found
