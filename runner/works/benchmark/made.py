"""What was made: the arms, laws and conditions of the runs, and what the laws did there, worked out once."""

from collections.abc import Mapping, Sequence

from runner.reporting.job import Made, MissingError
from runner.reporting.prose.patterns import found
from runner.store import Run
from runner.works.benchmark.cells import ALL_SEEDS, Cell, cells, tuned

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


_TUNINGS = 3  # of a half


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
        MissingError: if there are no such runs.
    """
    found_there = all_cells(runs, arm, gains)
    if condition not in found_there:
        raise MissingError(f"{ARMS[arm]}, {CONDITIONS[condition]}: no such runs were made")
    return found_there[condition]


def arms_of(runs: Mapping[str, Run]) -> list[str]:
    """Return the arms of the runs, in one order."""
    names = [*runs, *(runs.missing if isinstance(runs, Made) else ())]
    there = {name.split("/")[1] for name in names if name.startswith("laws/")}
    return [arm for arm in ARMS if arm in there]


def laws_of(runs: Mapping[str, Run], arm: str) -> list[str]:
    """Return the laws that were run on an arm, in the order of the plan."""
    return list(dict.fromkeys(one.levels["law"] for one in found(runs, f"laws/{arm}/{{law}}/{{task}}/exact/untuned")))


def halves(runs: Mapping[str, Run]) -> tuple[int, int, int]:
    """Return how many drawn leads each half shows, and of these the other one, too, or turned round.

    A half is half of the seeds with the gains of three tunings; it is held against the other half of the seeds with
    the gains of the other three.

    Raises:
        MissingError: if there are fewer than six tunings.
    """
    gains = tuned(runs)
    if len(gains) < 2 * _TUNINGS:
        raise MissingError(f"halves of the tunings: there are {len(gains)} of them, and a half has {_TUNINGS}")
    ones, others = gains[:_TUNINGS], gains[_TUNINGS : 2 * _TUNINGS]
    even, odd = slice(0, None, 2), slice(1, None, 2)
    said = again = turned = 0
    for one, other in ((even, odd), (odd, even)):
        a, b = _shown(runs, one, ones), _shown(runs, other, others)
        said += len(a) + len(b)
        again += 2 * len(a & b)
        turned += 2 * len({(arm, name, (behind, law)) for arm, name, (law, behind) in a} & b)
    return said, again, turned


def _shown(runs: Mapping[str, Run], seeds: slice, gains: Sequence[str]) -> set[tuple[str, str, tuple[str, str]]]:
    return {
        (arm, name, key)
        for arm in arms_of(runs)
        for name, cell in all_cells(runs, arm, gains, seeds).items()
        for key, lead in cell.leads.items()
        if lead.shown and lead.p_value is not None
    }
