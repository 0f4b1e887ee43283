"""The README and the pages of docs/ against what a reader gets: commands, Python, links and pictures."""

import re

import pytest
from support.pages import ROOT, complaints, follow, has_python, pages, steps, wrong_snippets

from runner.config.compose.files import group_options

README = ROOT / "README.md"
FOLLOWED = [page for page in pages() if steps(page) or has_python(page)]
ALL = [*pages(), *(page for page in sorted(ROOT.glob("*.md")) if page != README)]


@pytest.fixture(scope="session")
def first_lines(tmp_path_factory):
    """A folder in which a reader typed the first lines of the README, and how they ended."""
    folder = tmp_path_factory.mktemp("reader")
    return folder, follow(steps(README, until="First run"), folder)


def test_the_first_lines_of_the_readme_print_what_it_shows(first_lines):
    _, ended = first_lines
    assert len(ended) > 5
    assert complaints(ended) == []


def test_the_last_of_the_first_lines_writes_a_report(first_lines):
    folder, ended = first_lines
    (report,) = [one.printed.splitlines()[-1] for one in ended if one.step.command == "runner report latest"]
    assert {path.name for path in (folder / "checkout" / report).iterdir()} == {"report.html", "report.pdf"}


# Pages take minutes, as each command starts a process; `make test-pages` follows them, which .ci/run does, too.
@pytest.mark.slow
@pytest.mark.bullet  # the default plant, whose numbers they show
@pytest.mark.parametrize("page", FOLLOWED, ids=lambda page: page.stem)
def test_commands_and_then_python_do_what_a_page_shows(page, tmp_path, monkeypatch):
    assert complaints(follow(steps(page), tmp_path)) == []
    monkeypatch.chdir(tmp_path / "checkout")
    assert wrong_snippets(page) == []


def test_links_and_pictures_lead_to_files():
    targets = {
        (page, target)
        for page in ALL
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    }
    assert len(targets) > 150
    assert [f"{page.name}: {target}" for page, target in targets if not (page.parent / target).exists()] == []


def test_no_page_shows_the_name_of_a_stored_folder():
    named = [f"{page.name}: {name}" for page in pages() for name in re.findall(r"\b[0-9a-f]{24}\b", page.read_text())]
    assert named == []  # it follows from the source, and is another one tomorrow


def test_the_page_on_configs_names_all_options_of_a_group_or_says_that_there_are_more():
    rows = re.findall(r"^\| `(\w+)`[^|]* \| ([^|]+) \|", (ROOT / "docs" / "configs.md").read_text(), re.M)
    named = {group: " ".join(options for other, options in rows if other == group) for group, _ in rows}
    assert {group for group, options in named.items() if "..." in options} == {"experiment"}
    missing = {
        group: set(group_options(group)) - set(re.findall(r"\w+", options))
        for group, options in named.items()
        if "..." not in options
    }
    assert {group: left for group, left in missing.items() if left} == {}
