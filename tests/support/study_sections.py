"""Code that tests of the studies share: runs that are changed to fail, and the words of a section."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from runner.reporting.document import Curves, Notice, ReportBlock, Section, Table, Text
from runner.store import Run

FAILURE = {"reason": "diverged: for this test", "time": 0.01, "joint": "q1", "repetition": 0}


def failed(run: Run) -> Run:
    return replace(run, record={**run.record, "status": "failed", "failure": FAILURE, "metrics": {}})


def every_run(runs: Mapping[str, Run]) -> dict[str, Run]:
    return {name: failed(run) for name, run in runs.items()}


def every_third(runs: Mapping[str, Run], offset: int) -> dict[str, Run]:
    return {name: failed(run) if i % 3 == offset else run for i, (name, run) in enumerate(runs.items())}


def blocks(section: Section) -> Iterator[ReportBlock]:
    yield from section.blocks
    for below in section.sections:
        yield from blocks(below)


def texts(section: Section) -> Iterator[str]:
    for block in blocks(section):
        match block:
            case Notice():
                yield from (block.title, block.text)
            case Text():
                yield block.text
            case Table():
                yield from (block.caption, *(cell for line in block.lines for cell in line))
            case Curves():
                yield block.caption


def unfinished_texts(section: Section) -> list[str]:
    """Strings into which a value has gone that is none."""
    return [t for t in texts(section) if "None" in t or {"nan", "inf"} & set(t.split()) or "{" in t]
