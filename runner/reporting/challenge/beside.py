"""Scope of a conclusion: the sentence of its challenge, or the command that makes one with its expected time."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from runner.base.errors import RunnerError
from runner.base.quantities import format_duration
from runner.reporting.answers import Answer
from runner.reporting.challenge.words import short_scope
from runner.store.finished import Finished
from runner.store.kinds import KINDS, outputs_of
from runner.store.run import Run
from runner.sweeps.challenge.stored import Challenge, open_challenge

_DRAWS = 90  # of both sides for a variation: its looks, and its share of the turning values
_FIXED = 0.4  # s for a variation: its config, check and compilation, and a share of the combinations
_MOST_COMPARED = 2  # results that one challenge asks about


def scope_line(answers: Sequence[Answer], folders: Sequence[Path], words: Sequence[str] = ()) -> str:
    """Return the scope of the first conclusion of some answers; empty if they have none.

    Args:
        answers: The answers.
        folders: Folders of the results that they describe; of more than two there is no challenge.
        words: Arguments of `runner challenge` for these results; empty for a page, which is read on any machine.
    """
    first = next((one for one in answers if one.rank == 0 and one.sign), None)
    if first is None or len(folders) > _MOST_COMPARED:
        return ""
    found = [made for made in _challenges(folders) if made.question.metric == first.metric]
    if found:
        return short_scope(found[0])
    if not words:
        return "Not challenged: the command runner challenge tries other choices."  # a page marks no code
    command = shlex.join(["runner", "challenge", *words])
    return f"Not challenged: `{command}`{_time_text(first, outputs_of(folders[0]))} tries other choices."


def _time_text(answer: Answer, outputs: Path) -> str:
    """Return the expected time of a challenge in brackets, from the times of two stored runs; empty if unknown.

    At first use the laws are compiled for each variation, which takes two to four times as long.
    """
    from runner.sweeps.challenge.table import read_values  # Hydra, which pages do without

    pairs = answer.pairs
    if pairs is None:
        return ""
    names = pairs.a.hashes[int(pairs.of_a[0])], pairs.b.hashes[int(pairs.of_b[0])]
    try:
        draws = sum(_seconds_of_draw(Finished(outputs).open(name)) for name in names)
    except (RunnerError, KeyError, TypeError):  # a run is elsewhere, keeps no trace, or failed at once
        return ""
    variations = sum(map(len, read_values(()).values()))
    seconds = variations * (_FIXED + _DRAWS * draws / len(names))
    return f" (about {format_duration(5.0 * max(1, round(seconds / 5.0)))}, longer at first use)"


def _seconds_of_draw(run: Run) -> float:
    """Return the time of one repetition of a run with a trace, without its assembly, in s."""
    return float(run.record["timing"]["tick_time_median"]) * (len(run.t) - 1)


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
