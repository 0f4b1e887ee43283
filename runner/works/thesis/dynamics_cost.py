"""The dynamics that "take several minutes": what they take today, and how they grow with the number of joints."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.store import Run
from runner.works.thesis.dynamics_benchmark import FILE, TERMS, load

_TITLE = "What the dynamics cost"
_CYCLE = 0.010  # s, the thesis' typical sample time
_MINUTES = 120.0  # s, the least that "several minutes" can mean
_FITTED = 12  # joints from which on the power law is fitted
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
    long = joints >= _FITTED
    exponent, scale = np.polyfit(np.log(joints[long]), np.log(total[long]), 1)
    law = 1e6 * np.exp(scale) * joints[long] ** exponent
    shown = [*(times[term] for term in _USED), total, times["forward_dynamics"]]
    rows = [[f"{n:.0f}", *(number(1e6 * float(each[i])) for each in shown)] for i, n in enumerate(joints)]
    blocks: list[Block] = [
        Text(
            "The thesis derived the six-joint equations as symbols, several pages of them, and found that "
            "computations take several minutes or even longer, against a sample time of 10 ms. This is its reason "
            "against method 1 and for breaking the arm into two. Recursive algorithms compute the same numbers "
            "without ever forming the symbols. Times per call from Python, the shortest of several blocks of calls, "
            f"on {record['machine']}: a timing of that machine, which another one answers otherwise; chains of 1 to "
            f"{len(joints)} arms mounted on each other. The power law is fitted from {_FITTED} joints on, as the fixed "
            "cost of a call from Python is a large share of the time of fewer."
        ),
        Table(
            "Microseconds for mass matrix, Coriolis matrix and gravity torque, their sum, and forward dynamics in "
            "one pass.",
            ["joints", "M", "C", "G", "M, C and G", "forward dynamics"],
            rows,
            (0, 1, 2, 3, 4, 5),
        ),
        Curves(
            f"Time for M, C and G against the number of joints, and the power law from {_FITTED} joints on.",
            (
                Panel(
                    "",
                    "joints",
                    "time (µs)",
                    (
                        Series("M, C and G", joints, 1e6 * total, "points_line"),
                        Series(f"power {exponent:.2f}", joints[long], law, "dotted"),
                        Series("forward dynamics", joints, 1e6 * times["forward_dynamics"], "points_line"),
                    ),
                ),
            ),
            1,
        ),
        _finding(six, float(total[-1]), int(joints[-1]), float(exponent)),
    ]
    return Section(_TITLE, blocks)


def _finding(six: float, largest: float, joints: int, exponent: float) -> Finding:
    """Return what the times mean beside the thesis' cycle; the margins leave room for a machine ten times slower."""
    time = Measured("M, C and G of six joints", 1e6 * six, "µs")
    chain = Measured(f"M, C and G of {joints} joints", 1e6 * largest, "µs")
    power = Measured(f"power of the time from {_FITTED} joints on", exponent)
    return finding(
        f"On this machine six joints take {time}, not minutes",
        f"This is one part in {number(_CYCLE / six, 2)} of the thesis' cycle of {number(1e3 * _CYCLE)} ms, and some "
        f"{number(_MINUTES / six, 1)} times less than two minutes. From {_FITTED} joints on the time grows with the "
        f"power {number(exponent)} of their number, more slowly than the square: {joints} joints take {chain}, less "
        "than a tenth of the cycle. Computing time is no reason against the dynamics of the whole.",
        time < 1e6 * _CYCLE / 20.0,
        chain < 1e6 * _CYCLE / 10.0,
        power < 1.9,
    )
