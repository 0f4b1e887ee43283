"""Stored challenges: the question and the list of variations, written before the first run, and their words."""

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from runner.base.atomic import refuse_links, write_atomically
from runner.statistics.scope import JudgedVariation
from runner.statistics.turning import Turn
from runner.store.kinds import KINDS
from runner.store.seal import DamagedError, read_json, sealed_json
from runner.store.sweep import write_jobs
from runner.sweeps.challenge.combinations import Combination
from runner.sweeps.challenge.question import LeftOutVariation, Question, Side, Variation

_FILE = KINDS["challenge"].files[0]
_REMEDY = "the challenge's command writes it again"


@dataclass(frozen=True)
class AnsweredVariation:
    """A variation with what was found.

    Attributes:
        variation: The variation.
        judged: Its word; None if the budget cut it.
        medians: Medians of A and of B; None without a comparison.
        hashes: Runs of A and of B on the first block of seeds; empty if none was simulated.
        reason: Why it cannot be asked; empty otherwise.
    """

    variation: Variation
    judged: JudgedVariation | None = None
    medians: tuple[float | None, float | None] | None = None
    hashes: Sequence[str] = ()
    reason: str = ""


@dataclass(frozen=True)
class Turning:
    """A search along a numeric choice.

    Attributes:
        variation: Number of the variation at its end.
        turns: The turning values.
        labels: What is changed at each turning value, in words.
        vanishes: The value from which on the answer vanishes; None if it does not.
        label: What is changed at that value, in words.
    """

    variation: int
    turns: Sequence[Turn]
    labels: Sequence[str]
    vanishes: float | None = None
    label: str = ""


@dataclass(frozen=True)
class Challenge:
    """A challenge, running or ended.

    Attributes:
        folder: Its folder.
        question: The question.
        found: All variations in the order of the budget.
        left_out: Variations that do not apply.
        command: Command that makes or continues it.
        fresh: The asked case on fresh seeds; None before it is simulated.
        came_back: True if the stored answer came back on fresh seeds.
        turnings: Searches for turning values.
        combined: Combinations of several changes.
        ended: True if nothing is left to do within the budget.
        budget: The budget as given; empty for none.
        seconds: Wall-clock time of the last command, in s.
    """

    folder: Path
    question: Question
    found: Sequence[AnsweredVariation]
    left_out: Sequence[LeftOutVariation]
    command: str
    fresh: JudgedVariation | None = None
    came_back: bool = False
    turnings: Sequence[Turning] = ()
    combined: Sequence[Combination] = ()
    ended: bool = False
    budget: str = ""
    seconds: float = 0.0

    @property
    def is_stored(self) -> bool:
        """True if its folder has a challenge already, which an earlier command wrote."""
        return (self.folder / _FILE).exists()

    @property
    def cut(self) -> list[AnsweredVariation]:
        """The variations that the budget cut."""
        return [one for one in self.found if one.judged is None] if self.came_back else []

    def write(self, jobs: Sequence[tuple[Sequence[str], str]]) -> None:
        """Write the challenge and the list of its runs, which makes it a sweep for other commands.

        Raises:
            StoreError: if a file cannot be written.
        """
        refuse_links(self.folder.parent.parent, self.folder)
        content = asdict(self) | {"folder": ""}
        write_jobs(self.folder, jobs, self.command)
        write_atomically(self.folder / _FILE, sealed_json(_plain(content)))


def _plain(value: Any) -> Any:
    """Return a value as JSON allows it: an infinite number is null, a path is a string."""
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, Path):
        return str(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value


def place_of(
    outputs: Path, question: Question, found: Sequence[AnsweredVariation], left: Sequence[LeftOutVariation]
) -> Path:
    """Return the folder of a challenge, named by its question and list of variations."""
    asked = asdict(replace(question, config_dirs=(), asks=()))
    content = [asked, [asdict(one.variation) for one in found], [asdict(one) for one in left]]
    digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
    return outputs / KINDS["challenge"].folder / digest[:24]


def open_challenge(folder: Path) -> Challenge:
    """Open a stored challenge.

    Raises:
        DamagedError: if the folder is not a challenge, or is damaged.
    """
    path = folder / _FILE
    content = read_json(path, _REMEDY)
    try:
        return _read(folder, content)
    except (KeyError, TypeError, ValueError) as error:
        text = f"{type(error).__name__}: {error}"
        raise DamagedError(f"cannot read {path}: it does not describe a challenge: {text}; {_REMEDY}") from error


def _read(folder: Path, content: dict[str, Any]) -> Challenge:
    asked = dict(content["question"])
    first, second = (Side(**side) for side in asked["sides"])
    asked |= {"sides": (first, second), "config_dirs": [Path(name) for name in asked["config_dirs"]]}
    known = {key: content[key] for key in ("command", "came_back", "ended", "budget", "seconds")}
    return Challenge(
        folder,
        Question(**asked),
        [_found(one) for one in content["found"]],
        [LeftOutVariation(**one) for one in content["left_out"]],
        fresh=_judged(content["fresh"]),
        combined=[Combination(**one) for one in content["combined"]],
        turnings=[Turning(**{**one, "turns": [_turn(turn) for turn in one["turns"]]}) for one in content["turnings"]],
        **known,
    )


def _found(one: dict[str, Any]) -> AnsweredVariation:
    medians = one["medians"]
    return AnsweredVariation(
        Variation(**one["variation"]),
        _judged(one["judged"]),
        None if medians is None else (medians[0], medians[1]),
        one["hashes"],
        one["reason"],
    )


def _judged(one: dict[str, Any] | None) -> JudgedVariation | None:
    if one is None:
        return None
    ratio = one["log_ratio"]
    return JudgedVariation(**{**one, "log_ratio": None if ratio is None else tuple(ratio)})


def _turn(one: dict[str, Any]) -> Turn:
    return Turn(**{**one, "between": None if one["between"] is None else tuple(one["between"])})
