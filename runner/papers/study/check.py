"""Checks of a study: conditions that cannot fail, literal numbers, faulty formulas, unexpected caveats."""

import dataclasses
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Set
from fnmatch import fnmatchcase
from typing import Any

from runner.base.errors import RunnerError, nearest
from runner.base.paths import STUDY_FILE
from runner.papers.expressions.insertions import insertions
from runner.papers.study.chapters import Chapters, chapter_text
from runner.papers.study.conclusions import list_failed_findings
from runner.papers.study.expected_caveats import unexpected_caveats
from runner.papers.study.measured import Measured
from runner.papers.study.prose.expressions import ChapterValues
from runner.papers.study.prose.reader import Reading, Stated, conditions_of
from runner.papers.study.report import study_document
from runner.papers.study.results import LeftOutError, MissingError, Parts, Runs
from runner.papers.study.study import Study
from runner.reporting.document import Document
from runner.reporting.mathml import faulty


def problems(chapters: Chapters, document: Document | None = None) -> Iterator[str]:
    """Yield the problems of a study, a line each.

    Every chapter is read, so that each expression is evaluated; every condition is tried with changed values.

    Args:
        chapters: The chapters of the study, with their runs.
        document: Its report, if it exists.
    """
    study, runs = chapters.study, chapters.runs
    levels, readable = levels_in(study.parts().values()), True
    for file in study.manifest.files():
        try:
            yield from _of_chapter(study, file, chapters, levels)
        except LeftOutError:
            continue
        except RunnerError as error:
            readable = False
            yield f"{study.folder.name}/{file}: {error}" if isinstance(error, MissingError) else str(error)
    yield from (f"{study.name}: {name}: expected caveats: no run of it is named so" for name in _unused(study, runs))
    yield from unexpected_caveats(runs, study.expected)
    cover = study.manifest.cover
    if cover is not None and cover.run not in {**runs, **study.dropped()}:
        yield f"{study.folder.name}/{STUDY_FILE}: cover: no run '{cover.run}'{nearest(cover.run, list(runs))}"
    if document is not None or readable:
        document = document or study_document(chapters)
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
    name = f"{study.folder.name}/{file}"
    yield from never_failing(name, chapters.reading(path.stem))
    yield from typed_numbers(name, chapter_text(path), levels)


def _unused(study: Study, runs: Runs) -> Iterator[str]:
    patterns, names = dict.fromkeys(each.runs for each in study.expected), (*runs, *study.dropped())
    yield from (pattern for pattern in patterns if not any(fnmatchcase(name, pattern) for name in names))


_BOX = re.compile(r"^::: \w+ (.*?)^:::$", re.MULTILINE | re.DOTALL)
_MATHEMATICS = re.compile(r"\$[^$]*\$")
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?: [a-zA-Z%]+)?")
# Names that hold a digit: parts of the source, of the arm, and of what the studies number.
_NAMED = re.compile(
    r"\b(?:[Ff]igures?|[Ss]ections?|[Pp]ages?|[Tt]ables?|[Cc]laims?|[Cc]hapters?|[Ee]quations?|[Mm]ethods?|[Jj]oints?|"
    r"[Ll]inks?|[Ff]rames?|[Pp]oses?|Mini|xArm|Meca|rk|RK|q)"
    r"[ -]?\(?\d+(?:\.\d+)*(?:(?:, | and | or | to )\d+(?:\.\d+)*)*|^\d[a-c]?\. "
)


def typed_numbers(file: str, text: str, levels: Set[str]) -> Iterator[str]:
    """Yield each number that is typed into a finding of a chapter, with file and line.

    Args:
        file: Name of the chapter's file.
        text: Its content.
        levels: Levels of axes, as the names of the study's runs have them; these may be typed.
    """
    for box in _BOX.finditer(text):
        words = "\n".join("" if line.startswith("holds:") else line for line in _blank(box[1]).splitlines())
        for number in sorted(typed_in(words, levels)):
            place = words.index(number)
            line = text.count("\n", 0, box.start()) + words.count("\n", 0, place) + 1
            yield f"{file}:{line}: {number}: a number typed in a finding goes stale; insert {{{{ metric(...) }}}}"


def levels_in(names: Iterable[Parts]) -> set[str]:
    """Return the levels of axes in the parts of names, and what commas separate in them, as "16.7 ms"."""
    return {text for parts in names for axis, level in parts if axis for text in level.split(", ")}


def typed_in(words: str, levels: Set[str]) -> set[str]:
    """Return the numbers in a string, with their units, that are neither part of a name nor a level."""
    return set(_NUMBER.findall(_NAMED.sub("", _MATHEMATICS.sub("", words)))) - levels


def _blank(box: str) -> str:
    """Return a box with each insertion in it left out, its lines kept."""
    for start, stop in reversed(list(insertions(box))):
        box = box[:start] + "…" + "\n" * box.count("\n", start, stop) + box[stop:]
    return box


_CHANGES: tuple[Callable[[float], float | None], ...] = (
    lambda value: 1000.0 * value,
    lambda value: value / 1000.0,
    lambda value: value + 1000.0,  # only this makes 0, or a rounding error, large
    lambda value: value - 1000.0,
)


def never_failing(file: str, reading: Reading) -> list[str]:
    """Return the conditions of a chapter that hold whichever of its named values is changed, with file and line.

    Each value that a `{% set %}` of the chapter names is made a thousand times as large and small, and larger and
    smaller by a thousand, one at a time.

    Args:
        file: Name of the chapter's file, for messages.
        reading: What its file makes.
    """
    return [
        f"{file}:{each.line}: holds: {each.expression}: no change of a named value makes it fail; name what it is "
        "about by {% set NAME = EXPRESSION %}, or leave it out"
        for each in reading.stated
        if not _may_fail(file, each, reading.values)
    ]


def _may_fail(file: str, stated: Stated, values: ChapterValues) -> bool:
    """Return True if each condition of an expression fails for some change."""
    given = conditions_of(file, stated, values)
    fell = {
        index
        for instead in _changed(values.named)
        for index, condition in enumerate(conditions_of(file, stated, values, instead))
        if not condition.holds
    }
    return len(fell) == len(given)


def _changed(named: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for name, value in named.items():
        for change in _CHANGES:
            yield from ({name: other} for other in _each_changed(value, change))


def _each_changed(value: Any, change: Callable[[float], float | None]) -> Iterator[Any]:
    """Yield a value, which may be a list or group of them, with each measured value in it changed in turn."""
    if isinstance(value, Measured):
        if value.value is not None:
            yield dataclasses.replace(value, value=change(value.value), parts=())
    elif isinstance(value, Mapping):
        for name, own in value.items():
            yield from ({**value, name: other} for other in _each_changed(own, change))
    elif isinstance(value, list | tuple):
        for index, own in enumerate(value):
            yield from ([*value[:index], other, *value[index + 1 :]] for other in _each_changed(own, change))
