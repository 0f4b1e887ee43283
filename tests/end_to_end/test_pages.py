"""README.md is followed line by line, and its pictures, links and snippets are looked up."""

import doctest
import re

import pytest
from support.pages import ROOT, follow, is_shown, steps

PAGE = ROOT / "README.md"
TEXT = PAGE.read_text(encoding="utf-8")
EXAMPLE = {"EXAMPLE": str(ROOT / "examples" / "own_robot")}
BAD_INPUT = 2
LONG = ["Two controllers on your own arm", "The published works"]


def follow_section(section, folder):
    ended = follow(steps(PAGE, section), folder, EXAMPLE)
    assert ended
    for one in ended:
        assert one.code == (BAD_INPUT if "problem" in "".join(one.step.shown) else 0), one
        assert is_shown(one), one
    return ended


def test_five_lines_run_and_print_what_the_page_shows(tmp_path):
    ended = follow_section("Five lines", tmp_path)
    report = ended[4].printed.splitlines()[-1]
    assert {path.name for path in (tmp_path / report).iterdir()} == {"report.html", "report.pdf"}


@pytest.mark.slow
@pytest.mark.parametrize("section", LONG)
def test_long_sections(section, tmp_path):
    follow_section(section, tmp_path)


def test_no_command_stands_outside_these_sections():
    followed = [step for section in ("Install", "Five lines", *LONG) for step in steps(PAGE, section)]
    assert followed == steps(PAGE)


def test_snippets_of_python(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    example = doctest.DocTestParser().get_doctest(TEXT, {}, "README.md", None, 0)
    assert example.examples
    outcome = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE).run(example)
    assert outcome.failed == 0


def test_links_and_pictures_are_there():
    for target in re.findall(r"\]\(([^)#]+)", TEXT):
        assert (ROOT / target).exists(), target


def test_no_name_of_a_stored_folder_is_printed():
    assert not re.search(r"\b[0-9a-f]{24}\b", TEXT)
