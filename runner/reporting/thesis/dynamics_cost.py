"""The dynamics that "take several minutes": what they take today, and how they grow with the number of joints."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.quantities import number, quantity
from runner.reporting.thesis.dynamics_benchmark import FILE, TERMS, load
from runner.store import Run

_TITLE = "What the dynamics cost"
_CYCLE = 0.010  # s, the thesis' typical sample time
_MINUTES = 120.0  # s, the least that "several minutes" can mean
_USED = ("mass_matrix", "coriolis_matrix", "gravity")


def dynamics_cost_section(runs: Mapping[str, Run]) -> Section:
    """Return the measured times of M, C and G for 3 to 30 joints, from the file that the reproduction keeps."""
    outputs = next(iter(runs.values())).folder.parent.parent
    record = load(Path(outputs, FILE))
    if record is None:
        missing = Notice(
            "warning", "Not measured", f"There is no measurement in {FILE}; runner reproduce thesis makes it."
        )
        return Section(_TITLE, (missing,))
    joints = np.array([row["joints"] for row in record["rows"]], dtype=float)
    times = {term: np.array([row[term] for row in record["rows"]]) for term in TERMS}
    total = np.sum([times[term] for term in _USED], axis=0)
    six = float(np.interp(6.0, joints, total))
    exponent, scale = np.polyfit(np.log(joints), np.log(total), 1)
    shown = [*(times[term] for term in _USED), total, times["forward_dynamics"]]
    rows = [[f"{n:.0f}", *(number(1e6 * float(each[i])) for each in shown)] for i, n in enumerate(joints)]
    growth = (
        "more slowly than in proportion"
        if exponent < 0.95
        else "in proportion"
        if exponent < 1.05
        else "faster than in proportion, more slowly than the square"
        if exponent < 2.0
        else "as the square or faster"
    )
    fits = total[-1] < 0.1 * _CYCLE
    blocks: list[Block] = [
        Text(
            "The thesis derived the six-joint equations as symbols, several pages of them, and found that "
            "computations take several minutes or even longer, against a sample time of 10 ms. This is its reason "
            "against method 1 and for breaking the arm into two. Recursive algorithms compute the same numbers "
            "without ever forming the symbols. Times per call from Python, the shortest of several blocks of calls, "
            f"on {record['machine']}; chains of 1 to {len(joints)} arms mounted on each other."
        ),
        Table(
            "Microseconds for mass matrix, Coriolis matrix and gravity torque, their sum, and forward dynamics in "
            "one pass.",
            ["joints", "M", "C", "G", "M, C and G", "forward dynamics"],
            rows,
            (0, 1, 2, 3, 4, 5),
        ),
        Curves(
            "Time for M, C and G against the number of joints, and the power law through it.",
            (
                Panel(
                    "",
                    "joints",
                    "time (µs)",
                    (
                        Series("M, C and G", joints, 1e6 * total, "points_line"),
                        Series(f"power {exponent:.2f}", joints, 1e6 * np.exp(scale) * joints**exponent, "dotted"),
                        Series("forward dynamics", joints, 1e6 * times["forward_dynamics"], "points_line"),
                    ),
                ),
            ),
            1,
        ),
        Notice(
            "finding",
            f"Six joints take {number(1e6 * six, 2)} µs, not minutes",
            f"This is 1/{number(_CYCLE / six, 2)} of the 10 ms cycle, and some {number(_MINUTES / six, 1)} times "
            f"less than two minutes. The time grows {growth} (power {exponent:.2f}): {joints[-1]:.0f} joints take "
            f"{quantity(1e6 * float(total[-1]), 'µs', 2)}, which {'fits' if fits else 'does not fit'} into a tenth "
            "of the cycle. Computing time is no reason against the dynamics of the whole.",
        ),
    ]
    return Section(_TITLE, blocks)
