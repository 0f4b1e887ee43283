"""Report on a study: chapters, provenance, caveats, checklist of the source (`checklist.yaml`) and citation."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from runner.base.data_file import read_data
from runner.base.paths import studies_dir
from runner.papers.expressions.evaluator import OperationBudget, Scope
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.insertions import fill
from runner.papers.reporting.claims import Verdicts, find_conditional_claims
from runner.papers.study.chapters import Chapters
from runner.papers.study.expected_caveats import ExpectedCaveat, caveats_section, unexpected_caveats
from runner.papers.study.manifest import CoverRun
from runner.papers.study.results import Runs, distinct
from runner.papers.study.study import Study
from runner.reporting import outline
from runner.reporting.document import (
    Code,
    Cover,
    Document,
    Provenance,
    ReportBlock,
    Section,
    Table,
    Text,
)
from runner.reporting.figures import cover
from runner.reporting.outline import number_sections
from runner.reporting.run_report import provenance
from runner.schema.model import StrictModel
from runner.store import Calibration, Run

_FILE = "checklist.yaml"
_MISSING, _NOWHERE = "missing", "–"
_DRAWN = "drawn anew"  # what was not to be expected, and is there


class SourceItem(StrictModel):
    """A figure, table or formula of the source.

    Attributes:
        name: What it is called: "Figure 3.5" where the source has a number.
        about: What it shows, or where the source has it.
        state: What became of it in the report.
        section: Title of the section of the report that contains it; if empty, its number in the source finds it.
        absent: Why it is not to be expected in the report; empty where it is.
    """

    name: Annotated[str, Field(min_length=1)]
    about: str
    state: Annotated[str, Field(min_length=1)]
    section: str = ""
    absent: str = ""


class Checklist(StrictModel):
    """Figures, tables and formulas of a source, with text on them.

    Attributes:
        title: Title of the section.
        text: What is to be said of the source. In double braces: `figures` and `tables`, how many items are called so;
            `expected`, how many items are to be in the report; `here`, how many of these are; `missing`, the sentence
            on those that are not.
        complete: What stands for `missing` where nothing is.
        incomplete: What stands for it otherwise; in double braces `names`, those of the items.
        caption: Caption of the table.
        columns: Headers of the items' names and of what they are about.
        items: The items in the order of the source.
    """

    title: str
    text: str
    complete: str
    incomplete: str
    caption: str
    columns: Annotated[list[str], Field(min_length=2, max_length=2)]
    items: Annotated[list[SourceItem], Field(min_length=1)]

    @model_validator(mode="after")
    def _check_braces(self) -> Self:
        for key, text, names in (
            ("text", self.text, ("figures", "tables", "expected", "here", "missing")),
            ("incomplete", self.incomplete, ("names",)),
        ):
            try:
                _filled(text, **dict.fromkeys(names, ""))
            except ExpressionError as error:
                raise ValueError(f"{key}: {error.reason}") from None
        return self

    def section(self, sections: Sequence[Section]) -> Section:
        """Return the checklist, its places found in the report itself.

        Args:
            sections: All chapters of the report from its first on, those that follow the checklist may be left out.
        """
        titles, numbers = _places(sections)
        places = [titles.get(item.section) if item.section else numbers.get(item.name.lower()) for item in self.items]
        rows = [_row(item, place) for item, place in zip(self.items, places, strict=True)]
        missing = [name for name, _, state, _ in rows if state == _MISSING]
        expected = sum(not item.absent for item in self.items)
        told = _filled(self.incomplete, names=", ".join(missing)) if missing else self.complete
        text = _filled(
            self.text,
            figures=sum(item.name.startswith("Figure ") for item in self.items),
            tables=sum(item.name.startswith("Table ") for item in self.items),
            expected=expected,
            here=expected - len(missing),
            missing=told,
        )
        return Section(
            self.title, (Text(text), Table(self.caption, [*self.columns, "state", "where"], rows, prose=True))
        )


def _filled(text: str, **values: str | int) -> str:
    return fill(text, Scope({}, values), OperationBudget())


def load_checklist(study: str | Path) -> Checklist | None:
    """Return the checklist of a study; None where it has none.

    Args:
        study: Name of a built-in study, such as "thesis", or the whole path of a study's folder.

    Raises:
        RunnerError: if its file cannot be read or does not fit; names the file, and the items and keys.
    """
    path = studies_dir() / study / _FILE
    return read_data(path, Checklist) if path.is_file() else None


def _row(item: SourceItem, place: str | None) -> list[str]:
    """Return an item's name, its subject, its state, and its section."""
    if place is not None:
        return [item.name, item.about, _DRAWN if item.absent else item.state, place]
    return [item.name, item.about, f"{item.state}: {item.absent}" if item.absent else _MISSING, _NOWHERE]


def _places(sections: Sequence[Section]) -> tuple[dict[str, str], dict[str, str]]:
    """Return the section of each title, and the first section of each number of the source in lower case."""
    titles: dict[str, str] = {}
    numbers: dict[str, str] = {}
    for chapter in outline.number_sections(sections):
        place = f"§{chapter.number}"
        titles[chapter.section.title] = place
        for block in chapter.section.blocks:
            if hasattr(block, "origin") and block.origin.number:
                numbers.setdefault(block.origin.number.lower(), place)
    return titles, numbers


def study_document(chapters: Chapters) -> Document:
    """Return the report on a study, from its chapters and their runs."""
    study, runs, made = chapters.study, chapters.runs, chapters.sections()
    manifest, first = study.manifest, 1 if made and made[0].answers else 0  # answers come before what is said of runs
    missing = [_missing(runs.missing)] if runs.missing else []
    before = [*made[:first], *_by_profile(study, runs), *missing, *made[first:]]
    about = study.code.about()
    sections = [*before, caveats_section(runs, study.expected), _where_from(runs, chapters.calibrations, about)]
    date = max((str(run.provenance["date"]) for run in runs.values()), default="")
    checklist = load_checklist(study.folder)
    listed = [checklist.section(sections)] if checklist else []
    everything = [*sections, *listed, citing_section(manifest.title, manifest.source, manifest.bibtex, runs)]
    notes = _notes(made, runs, study.expected)
    cover = _cover(manifest.cover, runs)
    return Document(manifest.title, manifest.source, manifest.abstract, everything, date, cover, notes)


def _by_profile(study: Study, runs: Runs) -> list[Section]:
    """Return the differences of the profile from the whole study; nothing without any."""
    dropped, repetitions = study.dropped(), study.chosen.repetitions if study.chosen else None
    if not (dropped or repetitions):
        return []
    less = " and leaves out some of the whole study" if dropped else ""
    each = f" Every run has {repetitions} repetitions." if repetitions else ""
    text = f"The profile {study.profile} takes {len(distinct(runs)):,} runs{less}.{each}"
    return [Section("Made with a profile", (Text(text),))]


def _cover(wanted: CoverRun | None, runs: Runs) -> Cover | None:
    """Return the picture of the first screen; None where there is none, or its run was not made."""
    if wanted is None or wanted.run not in runs or runs[wanted.run].status == "failed":
        return None
    return cover(runs[wanted.run], wanted.caption, wanted.end)


def _notes(chapters: Sequence[Section], runs: Mapping[str, Run], expected: Sequence[ExpectedCaveat]) -> list[str]:
    """Return the meanings of the verdicts, the conditions that they depend on, and the number of caveats."""
    blocks = [block for each in number_sections(chapters) for block in each.section.blocks]
    legends = dict.fromkeys(block.legend for block in blocks if isinstance(block, Verdicts))
    everything = distinct(runs)
    carrying = sum(bool(run.caveats) for run in everything)
    strange = len(unexpected_caveats(runs, expected))
    told = f"{strange} caveats are not expected" if strange else "all of them expected and explained"
    caveats = f"Caveats: {carrying} of {len(everything)} runs carry some, {told}." if carrying else ""
    return [text for text in (*legends, find_conditional_claims(blocks), caveats) if text]


def _where_from(runs: Mapping[str, Run], calibrations: Mapping[str, Calibration], code: str) -> Section:
    count, found = len(distinct(runs)), len(distinct(calibrations))
    more, folders = (f" and {found} calibrations", " and outputs/calibrations") if calibrations else ("", "")
    text = (
        f"{count} runs{more} lie behind this report, each stored with its config, trace and metrics under "
        f"outputs/runs{folders}. Figures show repetition 0; numbers are medians over the repetitions."
    )
    blocks: list[ReportBlock] = [Text(text)]
    if runs:
        rows = provenance(list(runs.values())).rows
        blocks.append(Provenance([*rows, *([("code of the study", code)] if code else [])]))
    return Section("Provenance", blocks)


def _missing(missing: Mapping[str, str]) -> Section:
    caption = "Not made, and so missing in this report; the same command makes them."
    table = Table(caption, ["name", "why"], list(missing.items()))
    return Section("Missing results", (table,))


_SPECIAL = re.compile(r"[&%$#_{}~^\\]")


def citing_section(title: str, source: str, bibtex: str, runs: Mapping[str, Run]) -> Section:
    """Return the citations of the report and, if it is known, of its source.

    Args:
        title: Title of the study.
        source: Whose it is.
        bibtex: Entry of the source; empty where there is none.
        runs: The stored runs behind the report, by name.
    """
    newest = max(runs.values(), key=lambda run: str(run.provenance["date"]), default=None)
    blocks: list[ReportBlock] = [Text("The source:"), Code(bibtex.strip())] if bibtex.strip() else []
    return Section("Cite this", [*blocks, Text("This report:"), Code(_report(title, source, newest))])


def _report(title: str, source: str, newest: Run | None) -> str:
    provenance: Mapping[str, object] = {} if newest is None else newest.provenance
    commit, date = str(provenance.get("commit") or ""), str(provenance.get("date") or "")
    made = f"Made by arm-control-runner{f', commit {commit[:12]}' if commit else ''}{f', {date}' if date else ''}"
    key = "-".join(re.findall(r"[a-z0-9]+", title.lower())[:4])
    fields = {
        "title": f"{{{_plain(title)}}}: {_plain(source)}",
        "author": "{arm-control-runner}",
        **({"year": date[:4]} if date else {}),
        "note": _plain(made),
    }
    return "\n".join([f"@misc{{{key}-reproduced,", *(f"  {name} = {{{text}}}," for name, text in fields.items()), "}"])


def _plain(text: str) -> str:
    """Return a string without characters that have a meaning in BibTeX."""
    return _SPECIAL.sub(lambda found: f"\\{found[0]}" if found[0] in "&%$#_{}" else " ", text)
