"""Result of a paired comparison: a pandas table with the answers in words."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from runner.reporting.answers import Answer
from runner.reporting.challenge.beside import scope_line
from runner.reporting.comparison.sweeps import answer_rows
from runner.reporting.sentences import sentences


class Comparison(pd.DataFrame):
    """Table of a comparison, one row for each metric and pair; parts of it are plain pandas tables.

    Attributes:
        summary: The answers in a few sentences: which is smaller, by how much, and how sure that is; then for which
            choices the first one holds, or the command that asks so.
    """

    _metadata = ["summary"]  # noqa: RUF012 - pandas reads it so
    summary: str

    @property
    def _constructor(self) -> Callable[..., pd.DataFrame]:
        return pd.DataFrame


def comparison(
    answers: Sequence[Answer], folders: Sequence[Path], groups: Sequence[Sequence[Answer]] = ()
) -> Comparison:
    """Return answers as a table.

    Args:
        answers: The rows.
        folders: Folders of the results that they describe.
        groups: The answers to each question, if there are several.
    """
    table = Comparison(pd.DataFrame(answer_rows(answers)).astype({"low": float, "high": float, "p": float}))
    texts = [text for group in groups or [answers] for text in sentences(group)]
    table.summary = "\n".join([*texts, *filter(None, [scope_line(answers, folders, list(map(str, folders)))])])
    return table
