"""Cached benchmark results: arms, controllers and conditions of the runs."""

from collections.abc import Mapping, Sequence

from runner.reporting.answers import SHARE
from runner.reporting.words import in_words
from runner.store import Run
from runner.studies.benchmark.cells import ALL_SEEDS, ROUND, Cell, cells
from runner.study.job import LeftOutError, Results
from runner.study.prose.patterns import found

ARMS = {
    "macro": "Macro",
    "planar": "planar arm",
    "xarm7": "xArm7",
    "panda": "Panda",
    "mini": "Mini",
    "meca500": "Meca500",
    "kuka": "KUKA iiwa",
}
LATER = (8, 16)
"""Rounds after which the order of the laws is looked at again."""

_FIRST = 3  # laws whose order is to stay
QUESTIONS = {"first": "from the first second", "learned": "once learned"}
CHANGES = {
    "slow": "half as fast: 4 s a round",
    "fast": "twice as fast: 1 s a round",
    "half": "half of the trials: 16",
    "untuned": "no tuning: gains of the bandwidth",
}
CONDITIONS = {
    "exact": "nothing is wrong",
    "masses_10": "masses wrong by 10 %",
    "masses": "masses wrong by 30 %",
    "friction": "unknown friction",
    "encoders": "encoder noise",
    "resolution": "coarse encoders",
    "limits_150": "torques up to 150 %",
    "limits_110": "torques up to 110 %",
    "limits_80": "torques up to 80 %",
    "delay_1": "a tick late",
    "delay_2": "two ticks late",
    "payload": "a load on the way",
    "all": "masses, friction and noise",
}


class _Kept:
    """What was worked out of the runs of one study, as every table and finding asks for it again."""

    runs: Mapping[str, Run]
    cells: dict[tuple[object, ...], dict[str, Cell]]

    def __init__(self) -> None:
        self.runs, self.cells = {}, {}


_kept = _Kept()


def all_cells(
    runs: Mapping[str, Run],
    arm: str,
    question: str = "first",
    gains: Sequence[str] = (),
    seeds: slice = ALL_SEEDS,
    after: int = ROUND,
) -> dict[str, Cell]:
    """Return what the laws did on an arm, by condition, in one order; `question` is one of QUESTIONS. See cells."""
    if _kept.runs is not runs:
        _kept.runs, _kept.cells = runs, {}
    key = (arm, question, tuple(gains), seeds.start, seeds.step, after)
    if key not in _kept.cells:
        made = cells(runs, arm, question, seeds, gains, after=after)
        _kept.cells[key] = {condition: made[condition] for condition in (*CONDITIONS, *CHANGES) if condition in made}
    return _kept.cells[key]


def one_cell(
    runs: Mapping[str, Run], arm: str, condition: str, question: str = "first", gains: Sequence[str] = ()
) -> Cell:
    """Return what the laws did on an arm under a condition; see all_cells.

    Raises:
        LeftOutError: if there are no such runs.
    """
    found_there = all_cells(runs, arm, question, gains)
    if condition not in found_there:
        raise LeftOutError(f"{ARMS[arm]}, {CONDITIONS[condition]}")
    return found_there[condition]


def turned(runs: Mapping[str, Run], arm: str, condition: str) -> str:
    """Return which of the first three laws is passed in a later round, and by which law; empty where none is.

    One law passes another where it is behind by more than 2 % in the round that is judged, and ahead by more later.
    """
    judged = all_cells(runs, arm, "learned")[condition].entries
    for after in LATER:
        later = {each.law: each.score for each in all_cells(runs, arm, "learned", after=after)[condition].entries}
        for place, one in enumerate(judged[:_FIRST]):
            for other in judged[place + 1 :]:
                was_ahead = one.score < (1.0 - SHARE) * other.score
                if was_ahead and later[other.law] < (1.0 - SHARE) * later[one.law]:
                    return f"{in_words(other.law)} passes {in_words(one.law)} by round {after}"
    return ""


def arms_of(runs: Mapping[str, Run]) -> list[str]:
    """Return the arms of the runs, in one order."""
    names = [*runs, *(runs.missing if isinstance(runs, Results) else ())]
    there = {name.split("/")[1] for name in names if name.startswith("first/")}
    return [arm for arm in ARMS if arm in there]


def laws_of(runs: Mapping[str, Run], arm: str) -> list[str]:
    """Return the laws that were run on an arm, in the order of the plan."""
    return list(dict.fromkeys(one.levels["law"] for one in found(runs, f"first/{arm}/{{law}}/{{task}}/exact/untuned")))
