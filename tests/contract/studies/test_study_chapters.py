"""Chapters of all studies, from the runs of thin plans: their sections, their strings, and conditions that can fail."""

import re
from collections.abc import Callable, Mapping

import pytest
from fixtures.studies import Made
from support.study_plans import STUDIES, chapters_made
from support.study_sections import every_run, every_third, unfinished_texts

from runner.papers.study.check import never_failing
from runner.papers.study.study import load_study
from runner.reporting import outline
from runner.reporting.document import Document, Section
from runner.reporting.mathml import faulty
from runner.store import Run

FILES = {study: chapters_made(study) for study in STUDIES}
# The chapters of engines load arms into PyBullet; the runs of meca500 are made here, some of them at walls.
NEEDS = {"engines": pytest.mark.bullet, "meca500": pytest.mark.bullet}
CHAPTERS = [
    pytest.param(study, file, id=f"{study}/{file}", marks=NEEDS.get(study, ()))
    for study, files in FILES.items()
    for file in files
]
STANDING_OF_THE_THESIS = (
    *("questions", "coupling", "mass_ratio", "folding", "stretch", "reference_velocity", "turns", "whole_body"),
    "how_sure",
)
# Other chapters are left out of the report if a run that they need has failed.
STANDING = {
    **{study: files for study, files in FILES.items() if study not in ("thesis", "thesis_beyond", "meca500")},
    "thesis": [file for file in FILES["thesis"] if file.removesuffix(".md") in STANDING_OF_THE_THESIS],
}
OF_ROUNDING = {  # inverses of singular matrices
    "xarm7/why_it_failed.md": (
        r"caption: \|J X - 1\| of the printed pseudo-inverse",
        r"measured: median \|J X - 1\|",
        r"measured: smallest \|J X - 1\|",
        r"measured: share of the cases that NumPy refuses",
        r"caption: Of the seven singular values",
    )
}
FINISHED = ("condition numbers inf (force)", "No joint passes its position limit")  # these words are meant
SPOILED: dict[str, Callable[[Mapping[str, Run]], Mapping[str, Run]]] = {
    "all": every_run,
    **{f"third {first}": lambda runs, first=first: every_third(runs, first) for first in range(3)},
}
# One third goes through the same branches as another. The others are slow: each may fail by itself.
SPOILS = [pytest.param(name, marks=() if name in ("all", "third 0") else pytest.mark.slow) for name in SPOILED]


@pytest.mark.costs(3)
@pytest.mark.parametrize(("study", "file"), CHAPTERS)
def test_a_chapter_has_its_sections_and_each_condition_can_fail(
    made: Callable[[str], Made], as_recorded: Callable[..., None], study: str, file: str
) -> None:
    chapters = made(study).chapters
    section = chapters.section(file)
    assert section.blocks or section.sections
    assert faults(section) == []
    as_recorded(study, file, section, OF_ROUNDING.get(f"{study}/{file}", ()))
    if file.endswith(".md"):
        text = (load_study(study).folder / file).read_text(encoding="utf-8")
        written = re.findall(r"^## (.*)$", text, re.MULTILINE)
        assert set(written) <= {each.section.title for each in outline.number_sections([section])}
        assert never_failing(file, chapters.reading(file.removesuffix(".md"))) == []


@pytest.mark.costs(5)
@pytest.mark.parametrize("spoil", SPOILS)
@pytest.mark.parametrize("study", [pytest.param(study, marks=NEEDS.get(study, ())) for study in STANDING])
def test_chapters_stand_whatever_has_failed(made: Callable[[str], Made], study: str, spoil: str) -> None:
    chapters = made(study).spoiled(SPOILED[spoil])
    for file in STANDING[study]:
        assert (file, faults(chapters.section(file))) == (file, [])


def faults(section: Section) -> list[str]:
    """Return strings into which a value has gone that is none, and formulas that cannot be set."""
    unfinished = [text for text in unfinished_texts(section) if not text.startswith(FINISHED)]
    return [*unfinished, *faulty(Document("", "", "", [section], "2026-01-01"))]
