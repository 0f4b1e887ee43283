"""Chapters of a report: Markdown with expressions, read into typed blocks of a Document."""

from runner.study.prose.expressions import ProseError
from runner.study.prose.reader import read_chapter

__all__ = ["ProseError", "read_chapter"]
