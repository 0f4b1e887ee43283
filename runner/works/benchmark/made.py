"""What was made: the arms, laws and conditions of the runs, and what the laws did there, worked out once."""

from collections.abc import Mapping, Sequence

from runner.reporting.job import LeftOutError, Made
from runner.reporting.prose.patterns import found
from runner.store import Run
from runner.works.benchmark.cells import ALL_SEEDS, Cell, cells

ARMS = {
    "macro": "Macro",
    "planar": "planar arm",
    "xarm7": "xArm7",
    "mini": "Mini",
    "meca500": "Meca500",
    "kuka": "KUKA iiwa",
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
    """What was worked out of the runs of one work, as every table and finding asks for it anew."""

    runs: Mapping[str, Run]
    cells: dict[tuple[object, ...], dict[str, Cell]]

    def __init__(self) -> None:
        self.runs, self.cells = {}, {}


_kept = _Kept()


def all_cells(
    runs: Mapping[str, Run], arm: str, gains: Sequence[str] = (), seeds: slice = ALL_SEEDS
) -> dict[str, Cell]:
    """Return what the laws did on an arm, by condition, in one order; see cells."""
    if _kept.runs is not runs:
        _kept.runs, _kept.cells = runs, {}
    key = (arm, tuple(gains), seeds.start, seeds.step)
    if key not in _kept.cells:
        made = cells(runs, arm, seeds=seeds, gains=gains)
        _kept.cells[key] = {condition: made[condition] for condition in CONDITIONS if condition in made}
    return _kept.cells[key]


def one_cell(runs: Mapping[str, Run], arm: str, condition: str, gains: Sequence[str] = ()) -> Cell:
    """Return what the laws did on an arm under a condition; see all_cells.

    Raises:
        LeftOutError: if there are no such runs.
    """
    found_there = all_cells(runs, arm, gains)
    if condition not in found_there:
        raise LeftOutError(f"{ARMS[arm]}, {CONDITIONS[condition]}")
    return found_there[condition]


def arms_of(runs: Mapping[str, Run]) -> list[str]:
    """Return the arms of the runs, in one order."""
    names = [*runs, *(runs.missing if isinstance(runs, Made) else ())]
    there = {name.split("/")[1] for name in names if name.startswith("laws/")}
    return [arm for arm in ARMS if arm in there]


def laws_of(runs: Mapping[str, Run], arm: str) -> list[str]:
    """Return the laws that were run on an arm, in the order of the plan."""
    return list(dict.fromkeys(one.levels["law"] for one in found(runs, f"laws/{arm}/{{law}}/{{task}}/exact/untuned")))
