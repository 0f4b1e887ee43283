"""Scope of a conclusion: the sentence of its challenge, or the command that makes one."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from runner.base.errors import RunnerError
from runner.reporting.answers import Answer
from runner.reporting.challenge.words import short_scope
from runner.store.kinds import KINDS, outputs_of
from runner.sweeps.challenge.stored import Challenge, open_challenge


def scope_line(answers: Sequence[Answer], folders: Sequence[Path], words: Sequence[str] = ()) -> str:
    """Return the scope of the first conclusion of some answers; empty if they have none.

    Args:
        answers: The answers.
        folders: Folders of the results that they describe.
        words: Arguments of `runner challenge` for these results; empty to name no command line.
    """
    metric = next((one.metric for one in answers if one.rank == 0 and one.sign), "")
    if not metric:
        return ""
    found = [made for made in _challenges(folders) if made.question.metric == metric]
    if found:
        return short_scope(found[0])
    if not words:
        return "Not challenged: the command runner challenge tries other choices."  # a page marks no code
    return f"Not challenged: `{shlex.join(['runner', 'challenge', *words])}` tries other choices."


def _challenges(folders: Sequence[Path]) -> list[Challenge]:
    """Return the ended challenges of some results, the newest first; those that cannot be read are ignored."""
    names = [folder.resolve().name for folder in folders]
    kind = KINDS["challenge"]
    paths = (outputs_of(folders[0]) / kind.folder).glob(f"[!.]*/{kind.files[0]}")
    found = []
    for path in sorted(paths, key=lambda each: -each.stat().st_mtime):
        try:
            made = open_challenge(path.parent)
        except RunnerError:
            continue
        if made.ended and list(made.question.asks) == names:
            found.append(made)
    return found
