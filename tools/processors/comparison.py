"""Comparison of the bits of runs under each kernel with those on this processor."""

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import zip_longest
from typing import Any

from runner.caveats.rounding_growth import SENSITIVE
from tools.processors.bits import growth, make_under
from tools.processors.kernels import KERNELS, not_emulated
from tools.processors.runs import matrix

JUDGED = ("bullet/", "rk4/")
CAUSES: Mapping[str, str] = {"rk4/panda/joint_torques": "the force from joint torques, through products of BLAS"}
"""Why runs of JUDGED may differ under a kernel with AVX2, by the name of the run."""

_AVX2 = "haswell"
_FLOOR = 1e-12  # absolute, as in `runner check`


def compare() -> bool:
    """Make the runs under each kernel, and print what differs; return whether the judged ones have the same bits."""
    runs = matrix()
    with ThreadPoolExecutor(2) as pool:
        made = dict(
            zip([None, *KERNELS], pool.map(lambda kernel: make_under(kernel, runs), [None, *KERNELS]), strict=True)
        )
        grown = dict(zip(runs, pool.map(growth, runs.values()), strict=True))
    own = made.pop(None)
    for kernel in KERNELS:
        for missing in not_emulated(kernel):
            print(f"  not emulated: {missing}")
    print(f"{len(runs)} runs against this processor: metrics with other bits, and the largest relative change of one")
    print("moved: the same from a start moved by rounding, two draws; above 1e-6 in the first, a run has the caveat")
    print(f"{'':28}" + "".join(f"{kernel:>20}" for kernel in (*made, "moved")))
    met = True
    for name in runs:
        cells = [_cell(own[name], theirs[name]) for theirs in made.values()]
        marked, moves = grown[name][0] > SENSITIVE, [_largest(own[name], theirs[name]) for theirs in made.values()]
        other = name.startswith(JUDGED) and name not in CAUSES and not same(own[name], made[_AVX2][name])
        unmarked = max(moves) > SENSITIVE and not marked
        overdone = marked and max(*moves, grown[name][1]) <= SENSITIVE
        remark = "  OTHER BITS" * other + "  NOT MARKED" * unmarked + "  MARKED WITHOUT NEED" * overdone
        met &= not remark
        if any(cells) or marked:
            cells.append(" ".join(f"{change:.0e}" for change in grown[name]))
            print(f"{name:28}" + "".join(f"{cell or 'equal':>20}" for cell in cells) + remark)
    for kernel, theirs in made.items():
        for engine in sorted({name.partition("/")[0] for name in runs}):
            names = [name for name in runs if name.startswith(f"{engine}/")]
            equal = sum(same(own[name], theirs[name]) for name in names)
            print(f"{kernel}, {engine}: {equal} of {len(names)} equal")
    return met


def same(own: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Return whether two runs have the same bits in metrics and trace, and the same failure."""
    return own == other


def _cell(own: Mapping[str, Any], other: Mapping[str, Any]) -> str:
    if same(own, other):
        return ""
    changed = len(_changed(own, other))
    return f"{changed}, {_largest(own, other):.0e}" if changed else "trace"


def _changed(own: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    ours, theirs = own["metrics"], other["metrics"]
    return [name for name in {**ours, **theirs} if ours.get(name) != theirs.get(name)]


def _largest(own: Mapping[str, Any], other: Mapping[str, Any]) -> float:
    ours, theirs = own["metrics"], other["metrics"]
    return max((_change(ours.get(name, ()), theirs.get(name, ())) for name in _changed(own, other)), default=0.0)


def _change(ours: Sequence[float | None], theirs: Sequence[float | None]) -> float:
    """Return the largest relative change of a value, infinite if one has none, 0 below 1e-12."""
    pairs = list(zip_longest(ours, theirs))
    if any((a is None) is not (b is None) for a, b in pairs):
        return math.inf
    found = [(abs(a - b), max(abs(a), abs(b))) for a, b in pairs if a is not None and b is not None]
    return max((difference / size for difference, size in found if difference > _FLOOR), default=0.0)
