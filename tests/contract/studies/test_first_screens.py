"""First screens of the studies that answer a source: what is quoted is short and has its place; the rest is named."""

import re

import pytest

from runner.papers.study.measured import ANSWERS
from runner.papers.study.study import load_study

FIRST = {"thesis": "answers.md", "thesis_beyond": "answers.md", "xarm7": "claims.md", "meca500": "statements.md"}
QUOTED = re.compile(r'"([^"]+)" \([^)]*\b(?:page|section) \d[^)]*\)')
PLACED = re.compile(r"\(sections? \d[^)]*\)")
MOST_WORDS = 15
STEP = re.compile(r"\b(?:fitted|simulated) as the|as the thesis ran|the thesis ran it", re.I)


def problem(kind, title):
    """Return the problem of the title of an answer; an empty string if it has none."""
    quoted = QUOTED.search(title)
    if kind == "why" or title.startswith("Beyond the source: "):
        return ""
    if quoted is None:
        return "" if PLACED.search(title) else "answers no quoted words, and is not called beyond the source"
    return f"quotes more than {MOST_WORDS} words" if len(quoted[1].split()) > MOST_WORDS else ""


@pytest.mark.parametrize("study", FIRST)
def test_an_answer_quotes_what_it_answers(study):
    text = (load_study(study).folder / FIRST[study]).read_text(encoding="utf-8")
    titles = re.findall(rf"^::: ({'|'.join(ANSWERS)}) ((?:[^{{\n]|{{{{[^}}]*}}}})*)$", text, re.M)
    assert len(titles) == text.count("\n::: ") - text.count("\n::: finding") >= 4
    assert {title: told for kind, title in titles if (told := problem(kind, title))} == {}


def test_no_fit_is_called_what_the_thesis_ran():
    folder = load_study("thesis").folder
    texts = {
        path.name: path.read_text(encoding="utf-8") for suffix in ("md", "yaml") for path in folder.rglob(f"*.{suffix}")
    }
    assert [name for name, text in texts.items() if STEP.search(text)] == []


@pytest.mark.parametrize("study", FIRST)
def test_no_caption_of_curves_names_a_unit_of_length(study):
    """The axis has the unit that fits its values, often mm or µm."""
    texts = "\n".join(path.read_text(encoding="utf-8") for path in load_study(study).folder.rglob("*.md"))
    captions = re.findall(r'curves\("([^"]*)"', texts)
    assert captions or study != "thesis"
    assert [caption for caption in captions if re.search(r"\bin (?:m|mm|µm)\b", caption)] == []


@pytest.mark.parametrize(
    ("title", "wrong"),
    [
        ('"It works" (section 5, page 3): so.', False),
        ("Beyond the source: it rests.", False),
        ("24 equations (sections 1 and 7) are wrong.", False),
        ("It does not rest closer.", True),
        (f'"{"word " * 16}" (page 3): so.', True),
    ],
)
def test_an_answer_to_nothing_is_found(title, wrong):
    assert bool(problem("stands", title)) is wrong
