"""Checks of a study: conditions that cannot fail, typed numbers, faulty formulas, unexpected caveats."""

from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase

from runner.base.errors import RunnerError, nearest
from runner.base.paths import STUDY_FILE
from runner.reporting.document import Document
from runner.reporting.formulas import faulty
from runner.store import Calibration, Run
from runner.study.chapters import Chapters, chapter_text
from runner.study.conclusions import list_failed_findings
from runner.study.expected_caveats import unexpected_caveats
from runner.study.job import LeftOutError, MissingError
from runner.study.prose.condition_tests import never_failing
from runner.study.prose.typed import levels_in, typed_numbers
from runner.study.study import Study


def problems(study: Study, runs: Mapping[str, Run], calibrations: Mapping[str, Calibration]) -> Iterator[str]:
    """Yield what is wrong with a study, a line each.

    Every chapter is read, so that each expression is evaluated; every condition is tried with changed values.

    Args:
        study: The study.
        runs: Its stored runs by name.
        calibrations: Its stored calibrations by name.
    """
    levels, chapters = levels_in([*runs, *calibrations]), study.chapters(runs, calibrations)
    faults = 0
    for file in study.manifest.files():
        for line in _of_chapter(study, file, chapters, levels):
            faults += 1
            yield line
    yield from (f"{study.name}: {name}: expected caveats: no run of it is named so" for name in _unused(study, runs))
    yield from unexpected_caveats(runs, study.expected)
    cover = study.manifest.cover
    if cover is not None and cover.run not in {**runs, **study.dropped()}:
        yield f"{study.folder.name}/{STUDY_FILE}: cover: no run '{cover.run}'{nearest(cover.run, list(runs))}"
    if not faults:
        document = study.document(runs, calibrations, chapters)
        yield from list_failed_findings(document)
        yield from formulas_at(study, document)


def formulas_at(study: Study, document: Document) -> Iterator[str]:
    """Yield each formula of a study's report that cannot be read, with file and line where a chapter has it."""
    texts = [(file, chapter_text(study.folder / file)) for file in study.manifest.files()]
    for formula in faulty(document):
        found = ((file, text.count("\n", 0, text.index(formula)) + 1) for file, text in texts if formula in text)
        file, line = next(found, (STUDY_FILE, 1))
        yield f"{study.folder.name}/{file}:{line}: {formula}: no formula in Typst's notation"


def _of_chapter(study: Study, file: str, chapters: Chapters, levels: set[str]) -> Iterator[str]:
    path = study.folder / file
    if path.suffix != ".md":
        return
    text, name = chapter_text(path), f"{study.folder.name}/{file}"
    try:
        yield from never_failing(name, chapters.reading(path.stem))
    except LeftOutError:
        return
    except MissingError as error:
        yield f"{name}: {error}"
        return
    except RunnerError as error:
        yield str(error)
        return
    yield from typed_numbers(name, text, levels)


def _unused(study: Study, runs: Mapping[str, Run]) -> Iterator[str]:
    patterns, names = dict.fromkeys(each.runs for each in study.expected), (*runs, *study.dropped())
    yield from (pattern for pattern in patterns if not any(fnmatchcase(name, pattern) for name in names))
