"""Chapters of a report written as Markdown with expressions, read into the typed blocks of a Document."""

from runner.study.prose.problem import ProseError
from runner.study.prose.reader import read_chapter

__all__ = ["ProseError", "read_chapter"]
