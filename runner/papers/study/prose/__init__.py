"""Chapters of a report: Markdown with expressions, read into typed blocks of a Document."""

from runner.papers.study.prose.expressions import ProseError
from runner.papers.study.prose.reader import read_chapter

__all__ = ["ProseError", "read_chapter"]
