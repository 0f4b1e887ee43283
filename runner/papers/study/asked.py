"""Findings of a study, and verdicts on its printed numbers, as a challenge asks them: conditions, runs, choices."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import get_args

from runner.base.errors import RunnerError, nearest
from runner.papers.reporting.published_claims import CLAIMS, Verdict, load_claims
from runner.papers.study.chapters import Chapters, chapter_text
from runner.papers.study.claims import judge_number
from runner.papers.study.measured import ANSWERS, Condition, Measured, findings
from runner.papers.study.prose.reader import Box
from runner.papers.study.results import MissingError
from runner.papers.study.study import Study
from runner.reporting.document import Document

_BRACES = re.compile(r"\{\{.*?\}\}", re.S)
_BOX = re.compile(r"^::: *\w+ +(.+)$", re.M)
_VALUE = "\0"
_ADDED = 2  # chapters that a report may have before its own: on a profile, and on missing runs


@dataclass(frozen=True)
class AskedFinding:
    """A finding or the verdict on a claim, with its conditions.

    Attributes:
        number: Number of its section; that of the claim.
        title: Its title.
        ask: Function of chapters with other runs that returns its conditions.
        runs: Names of the runs that its conditions read.
        about: Choices that it compares itself.
        wider: Whether it is asked under equivalent choices and conditions, too.
    """

    number: str
    title: str
    ask: Callable[[Chapters], list[Condition]]
    runs: Sequence[str]
    about: Sequence[str] = ()
    wider: bool = False


def check_chosen(study: Study, chosen: str) -> None:
    """Check the choice of findings before the runs of a study are made, as far as its files tell.

    Values in a title are not known yet: one word of the choice in such a title is enough.

    Args:
        study: The study.
        chosen: Number of a section, or words of a title; empty for all findings.

    Raises:
        RunnerError: if there is no such finding.
    """
    chapters, titles = len(study.manifest.chapters), [*_titles_of_claims(study), *_titles_of_boxes(study)]
    if chosen.partition(".")[0].isdecimal():
        known = int(chosen.partition(".")[0]) <= chapters + _ADDED
    else:
        words = chosen.lower().split()
        known = any(
            chosen.lower() in title.lower() or (_VALUE in title and any(word in title.lower() for word in words))
            for title in titles
        )
    if not known:
        raise _no_finding(chosen, titles)


def _titles_of_boxes(study: Study) -> Iterator[str]:
    """Yield the title of each finding in Markdown, with a mark instead of a value."""
    for file in study.manifest.files():
        if file.endswith(".md"):
            text = _BRACES.sub(_VALUE, chapter_text(study.folder / file))
            yield from _BOX.findall(text)


def _titles_of_claims(study: Study) -> Iterator[str]:
    claims = load_claims(study.folder) if (study.folder / CLAIMS).is_file() else []
    for claim in claims:
        for words in (study.manifest.presets or {"": ""}).values():
            under = f", {words}" if words else ""
            yield from (f"Claim {claim.number}{under}: {verdict}" for verdict in get_args(Verdict))


def list_asked(chapters: Chapters, document: Document, chosen: str = "") -> list[AskedFinding]:
    """Return the findings and verdicts of a study; of a section, or with words in their title.

    Chosen findings and answers are asked under equivalent choices and conditions, too, if they compare runs.

    Args:
        chapters: The chapters of the study, with their runs.
        document: Its report.
        chosen: Number of a section, or words of a title; empty for all findings.

    Raises:
        RunnerError: if there is none.
    """
    every = [*_list_findings(chapters, document, bool(chosen)), *_list_claims(chapters)]
    if not every:
        raise RunnerError(
            "--challenge: no condition of a chapter in Markdown reads a run. Allowed: a study with findings."
        )
    return _choose(every, chosen)


def _list_findings(chapters: Chapters, document: Document, all_wider: bool) -> Iterator[AskedFinding]:
    """Yield the findings of all chapters in Markdown whose conditions read runs."""
    numbers = {id(found): number for number, found in findings(document)}
    for file in chapters.study.manifest.files():
        stem, _, suffix = file.rpartition(".")
        if suffix != "md":
            continue
        try:
            boxes = chapters.reading(stem).boxes
        except MissingError:
            continue
        for box in boxes:
            runs = [name for name in chapters.runs if name in box.read]
            if runs and id(box.finding) in numbers:
                wider = all_wider or box.finding.kind in ANSWERS[:3]
                ratio = len(runs) > 1 and any(len(each.values) > 1 for each in box.finding.conditions)
                ask = partial(_ask_box, stem, box)
                number = numbers[id(box.finding)]
                yield AskedFinding(number, box.finding.claim, ask, runs, box.about, wider and ratio)


def _ask_box(stem: str, box: Box, chapters: Chapters) -> list[Condition]:
    return chapters.ask(stem, box.stated)


def _list_claims(chapters: Chapters) -> Iterator[AskedFinding]:
    """Yield the verdicts on the printed numbers under each preset."""
    for claim in chapters.published:
        for preset, words in (chapters.study.manifest.presets or {"": ""}).items():
            try:
                (_, verdict), read = _judge_claim(claim.number, preset, chapters)
            except MissingError:
                continue
            if claim.metric and verdict != "undecided":
                under = f", {words}" if words else ""
                ask = partial(_ask_claim, claim.number, preset, verdict)
                yield AskedFinding(f"claim {claim.number}", f"Claim {claim.number}{under}: {verdict}", ask, read)


def _judge_claim(number: int, preset: str, chapters: Chapters) -> tuple[tuple[Measured, Verdict], list[str]]:
    """Return value and verdict of a claim under a preset, and the names of the runs that were read."""
    chapters.runs.read.clear()
    claims = chapters.published
    found = judge_number(next(each for each in claims if each.number == number), claims, chapters.runs, preset)
    return found, [name for name in chapters.runs if name in chapters.runs.read]


def _ask_claim(number: int, preset: str, verdict: Verdict, chapters: Chapters) -> list[Condition]:
    (value, now), _ = _judge_claim(number, preset, chapters)
    return [Condition(f"claim {number} {verdict}", now == verdict, f"{value}, {now}", (value,))]


def _choose(every: Sequence[AskedFinding], chosen: str) -> list[AskedFinding]:
    found = [one for one in every if not chosen or one.number == chosen or one.number.startswith(f"{chosen}.")]
    found = found or [one for one in every if chosen.lower() in one.title.lower()]
    if not found:
        raise _no_finding(chosen, [text for one in every for text in (one.number, one.title)])
    return found


def _no_finding(chosen: str, known: Sequence[str]) -> RunnerError:
    return RunnerError(
        f"--challenge: no finding '{chosen}'{nearest(chosen, known)}. Allowed: the number of a section, or words of a "
        "title."
    )
