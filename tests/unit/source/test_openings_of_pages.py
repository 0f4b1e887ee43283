"""Beginnings of the pages: a tutorial's result, a task's goal or a question, and soon a block, a figure or a table."""

import re

import pytest
from support.pages import ROOT, pages

NAV = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("\nnav:\n")[1]
GROUPS = {
    name: re.findall(r"- (\w+\.md)", rest)
    for name, rest in re.findall(r"^  - ([\w-]+):(.*?)(?=^  - |\Z)", NAV, re.M | re.S)
}
OPENINGS = {"Tutorials": "You will ", "How-to": "Goal: ", "Explanation": r"[^.]*\?"}
BLOCK = re.compile(r"^(?:    \S|```|!\[|\| |::: )", re.M)
MOST_WORDS = 60


def beginning(text):
    """Return a page's words between its title and the first block, figure or table; all words without one."""
    title, _, rest = text.partition("\n")
    assert title.startswith("# ")
    found = BLOCK.search(rest)
    return rest[: found.start() if found else None].strip()


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.stem)
def test_a_page_begins_with_something_to_type_or_to_see(page):
    assert len(beginning(page.read_text(encoding="utf-8")).split()) <= MOST_WORDS


@pytest.mark.parametrize(
    ("opening", "name"), [(opening, name) for group, opening in OPENINGS.items() for name in GROUPS[group]]
)
def test_a_page_begins_with_its_goal_or_its_question(opening, name):
    text = (ROOT / "docs" / name).read_text(encoding="utf-8")
    assert re.match(opening, text.partition("\n")[2].strip())


def test_the_navigation_has_six_groups_and_every_page():
    assert [*GROUPS] == ["Home", "Tutorials", "How-to", "Reference", "Explanation", "Project"]
    listed = [name for names in GROUPS.values() for name in names]
    assert {page.name for page in pages()[1:]} == {*listed} - {
        "index.md",
        "contributing.md",
        "changelog.md",
        "security.md",
    }
    assert len({*listed}) == len(listed)


def test_words_before_the_first_block_are_counted():
    assert beginning("# Title\n\nTwo words\n\n    $ runner\n") == "Two words"
    assert beginning("# Title\n\nOnly words.\n") == "Only words."
