"""Chapters of a study, from Markdown or Python files."""

import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property, partial
from inspect import signature
from pathlib import Path
from typing import Any

from runner.base import progress
from runner.base.errors import RunnerError, nearest
from runner.base.limits import CHAPTER, read_text
from runner.papers.audit.audit import audit
from runner.papers.audit.entry import parts as parts_in
from runner.papers.audit.sources import Source
from runner.papers.audit.verdict import SAMPLES, Check
from runner.papers.reporting.audit_report import rows
from runner.papers.reporting.claims import Claim, Verdicts
from runner.papers.reporting.equation import Equations, EquationVerdict
from runner.papers.reporting.published_claims import (
    CLAIMS,
    FACTOR,
    PublishedClaim,
    Verdict,
    load_claims,
    load_statements,
)
from runner.papers.study.claims import judged_claims, judged_statements, legend
from runner.papers.study.code import public_functions
from runner.papers.study.manifest import ChapterPart
from runner.papers.study.measured import Condition, Finding, Measured
from runner.papers.study.prose import blocks, plots, read_chapter, signals, tables
from runner.papers.study.prose.compared import compare
from runner.papers.study.prose.expressions import ChapterValues, needed_names
from runner.papers.study.prose.reader import Reading, Stated, conditions_of
from runner.papers.study.results import LeftOutError, MissingError, Results, Runs
from runner.papers.study.study import Study
from runner.reporting.document import Notice, Origin, Section, Text
from runner.reporting.markup import literal
from runner.reporting.outline import number_sections
from runner.store import Calibration, Run

SHARED = (blocks, signals, tables, plots)
"""The modules whose functions every chapter may call."""
_FIGURES = "figures"  # the module whose functions all chapters of a study may call
_SECTION = "section"  # the function of a chapter that is Python
_STATED = (
    "A statement matches when every condition of the findings on it is met, and differs when one is not. It is "
    "undecided when nothing here measures it. Equations are correct or wrong as printed by the audit."
)


class Chapters:
    """The chapters of a study, made from its stored runs and calibrations; each file is read once.

    Args:
        study: The study.
        runs: Its stored runs by name.
        calibrations: Its stored calibrations by name.
    """

    def __init__(self, study: Study, runs: Runs, calibrations: Results[Calibration]) -> None:
        self.study, self.runs, self.calibrations = study, runs, calibrations
        self._readings: dict[str, Reading] = {}

    def sections(self) -> list[Section]:
        """Return all chapters; one that needs what was not made says so in its place."""
        progress.begin("writing chapters", _count(self.study.manifest.chapters), "chapters")
        return self._each(self.study.manifest.chapters)

    def said(self, stem: str) -> dict[str, Any]:
        """Return the named numbers and strings of a chapter in Markdown, and as `holds` whether its findings hold."""
        made = self.reading(stem)
        self.runs.read.update(*(box.read for box in made.boxes))
        everything = [block for each in number_sections([made.section]) for block in each.section.blocks]
        holds = all(each.holds for each in everything if isinstance(each, Finding))
        return {"holds": holds, **{name: value for name, value in made.values.named.items() if _is_plain(value)}}

    def reading(self, stem: str) -> Reading:
        """Return the reading of a chapter in Markdown.

        Args:
            stem: Name of the file without its ending.

        Raises:
            ProseError: if it cannot be read.
            MissingError: if it needs what was not made.
        """
        if stem not in self._readings:
            file = f"{stem}.md"
            values = self.study.code.values(_FIGURES) + self.study.code.values(stem)
            self._readings[stem] = read_chapter(
                f"{self.study.folder.name}/{file}", self._text(file), self.names(stem), values, self.runs.read
            )
        return self._readings[stem]

    def ask(self, stem: str, stated: Sequence[Stated]) -> list[Condition]:
        """Return some conditions of a chapter in Markdown, of which nothing else is evaluated.

        Raises:
            ProseError: if a condition or a value in it cannot be evaluated.
            MissingError: if it needs what was not made.
        """
        file = f"{self.study.folder.name}/{stem}.md"
        text = self._text(f"{stem}.md")
        values = ChapterValues(file, self.names(stem), self.study.code.values(_FIGURES) + self.study.code.values(stem))
        values.name_values(text, needed_names(text, [each.expression for each in stated]))
        return [condition for each in stated for condition in conditions_of(file, each, values)]

    def names(self, stem: str) -> dict[str, Any]:
        """Return the functions and values that a chapter in Markdown may use, by name.

        These are the shared blocks, which find calibrations among the runs; the public functions of `figures.py` and of
        the module with the chapter's name; and what study.yaml, runs.yaml and claims.yaml hold. A function whose
        first argument is `runs` or `calibrations` gets these.
        """
        presets, tunings = self.study.manifest.presets, self.study.grids.tunings
        found: dict[str, Any] = {
            "level_of": self.study.grids.level,
            "value": self.study.grids.value,
            "ranges": {name: {key: [*own] for key, own in each.ranges.items()} for name, each in tunings.items()},
            "presets": presets,
            "words": self.study.manifest.words,
            "claims": self._claims,
            "claims_that": self._claims_that,
            "verdicts": lambda caption: Verdicts(caption, self._claims(), self._legend()),
            "verdict_rule": self._legend(),
            "verdict_factor": FACTOR,
            "equations": self._equations,
            "statements": self._statements,
            "said": self.said,
            "compare": partial(compare, self.runs, presets, self.published),
        }
        for module in SHARED:
            found |= _filled(public_functions(module), {"runs": self._stored})
        own = {"runs": self.runs, "calibrations": self.calibrations}
        for name in (_FIGURES, stem):
            found |= _filled(self.study.code.functions(name), own)
        return found

    @cached_property
    def _stored(self) -> Results[Run | Calibration]:
        """Return runs and calibrations in one."""
        runs, calibrations = self.runs, self.calibrations
        missing = {**runs.missing, **calibrations.missing}
        both: Results[Run | Calibration] = Results({**runs, **calibrations}, missing, runs.dropped, runs.parts)
        both.read = runs.read
        return both

    def _claims(self) -> list[Claim]:
        return judged_claims(self.published, self.runs, self.study.manifest.presets)

    @cached_property
    def published(self) -> list[PublishedClaim]:
        """The claims of the study; none if it has no file of them."""
        return load_claims(self.study.folder) if (self.study.folder / CLAIMS).is_file() else []

    def _legend(self) -> str:
        """Return the meaning of the words of its verdicts; empty without claims."""
        return legend(self.published)

    def _claims_that(self, verdict: Verdict, words: str, preset: str = "") -> Measured:
        """Return the number of claims with this verdict under a preset, or without one under all presets."""
        given = [{each.verdict for each in claim.findings if preset in ("", each.preset)} for claim in self._claims()]
        return Measured(words, float(given.count({verdict})))

    def _equations(self, caption: str) -> Equations:
        """Return the printed equations of the study with their verdicts."""
        checked = audit(Source(self.study.folder, self.study.code.runs))
        command = shlex.join(["runner", "reproduce", self.study.command])
        return Equations(caption, rows(checked), Origin(command=command), self.study.folder.name)

    def _statements(self, caption: str, judged: Mapping[str, tuple[Sequence[bool] | str, str]]) -> Verdicts:
        """Return the statements of the study by name, each with what its verdict follows from and what was measured.

        A statement matches if all of some findings hold, and differs otherwise. An equation has its id, whose verdict
        is the audit's; a statement that nothing measures is "undecided".
        """
        source = Source(self.study.folder, self.study.code.runs)
        equations = {entry.id: (part, entry) for part in parts_in(source) for entry in part.entries}

        def verdict(by: Sequence[bool] | str) -> Verdict | EquationVerdict:
            if not isinstance(by, str):
                return "matches" if all(by) else "differs"
            if by == "undecided":
                return "undecided"
            if by not in equations:
                raise RunnerError(f"no equation '{by}' in the folder{nearest(by, equations)}; or write \"undecided\"")
            part, entry = equations[by]
            return Check(part, SAMPLES).check(entry).verdict

        verdicts = {name: (verdict(by), measured) for name, (by, measured) in judged.items()}
        return Verdicts(caption, judged_statements(load_statements(self.study.folder), verdicts), _STATED)

    def _each(self, chapters: Sequence[str | ChapterPart]) -> list[Section]:
        return parts((self._title(each), partial(self._one, each)) for each in chapters)

    def _one(self, chapter: str | ChapterPart) -> Section:
        made = self.section(chapter)
        if not isinstance(chapter, ChapterPart):
            progress.step()
        return made

    def section(self, chapter: str | ChapterPart) -> Section:
        """Return the chapter of a file, such as "turns.md", or of several."""
        if isinstance(chapter, ChapterPart):
            return Section(chapter.title, sections=self._each(chapter.sections))
        stem, _, suffix = chapter.rpartition(".")
        if suffix == "md":
            return self.reading(stem).section
        make = self.study.code.functions(stem).get(_SECTION)
        if make is None:
            raise RunnerError(f"{self.study.folder / chapter}: must have a function {_SECTION}(runs)")
        section: Section = make(self.runs)
        return section

    def _title(self, chapter: str | ChapterPart) -> str:
        """Return the title of a chapter, or the file name of one in Python, to show if it is left out."""
        if isinstance(chapter, ChapterPart):
            return chapter.title
        heading = self._text(chapter).partition("\n")[0] if chapter.endswith(".md") else ""
        return heading.removeprefix("# ").strip() if heading.startswith("# ") else chapter

    def _text(self, file: str) -> str:
        return chapter_text(self.study.folder / file)


def parts(makers: Iterable[tuple[str, Callable[[], Section]]]) -> list[Section]:
    """Return chapters or sections, made one by one; one that needs what was not made says so instead.

    Args:
        makers: What each of them is called where it is left out, such as its file, and what makes it.
    """
    found = []
    for name, make in makers:
        try:
            found.append(make())
        except LeftOutError as error:
            text = f"The profile makes less than this part needs: {literal(str(error))}."
            found.append(Section(f"Left out: {literal(name)}", (Text(text),)))
        except MissingError as error:
            notice = Notice("failure", "Left out", f"This part needs what was not made: {literal(str(error))}.")
            found.append(Section(f"Left out: {literal(name)}", (notice,)))
    return found


def chapter_text(path: Path) -> str:
    """Return the content of a chapter.

    Raises:
        RunnerError: if it cannot be read, or is too large.
    """
    try:
        return read_text(path, CHAPTER)
    except (OSError, ValueError) as error:
        raise RunnerError(f"cannot read {path}: {error}") from None


def _count(chapters: Sequence[str | ChapterPart]) -> int:
    """Return the number of files that some chapters have."""
    return sum(len(each.sections) if isinstance(each, ChapterPart) else 1 for each in chapters)


def _is_plain(value: Any) -> bool:
    if isinstance(value, Mapping | list | tuple):
        return all(map(_is_plain, value.values() if isinstance(value, Mapping) else value))
    return isinstance(value, Measured | str | int | float)


def _filled(functions: Mapping[str, Callable[..., Any]], given: Mapping[str, Any]) -> dict[str, Callable[..., Any]]:
    """Return functions with their first argument where that is given."""
    firsts = {name: next(iter(signature(function).parameters), "") for name, function in functions.items()}
    return {
        name: partial(function, given[firsts[name]]) if firsts[name] in given else function
        for name, function in functions.items()
    }
