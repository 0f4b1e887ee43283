"""Chapters of a report written as Markdown with expressions, read into the typed blocks of a Document."""

from runner.reporting.prose.problem import ProseError
from runner.reporting.prose.reader import read_chapter

__all__ = ["ProseError", "read_chapter"]
