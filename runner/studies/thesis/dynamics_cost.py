"""Computing time of M, C and G over the number of joints, from the stored measurement."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from runner.base.quantities import number
from runner.reporting.document import Curves, Panel, Series, Table
from runner.store import Run
from runner.studies.thesis.measure import FILE, TERMS, load
from runner.study.job import MissingError
from runner.study.measured import Measured


def measured_cost(runs: Mapping[str, Run], fitted: int) -> dict[str, Any]:
    """Return measured times of chains of mounted arms, in µs, by what is measured, and how they grow.

    Args:
        runs: The runs of the study, beside which the measurement lies.
        fitted: The number of joints from which on the power of the number is fitted.

    Raises:
        MissingError: if there is none.
    """
    record = load(Path(next(iter(runs.values())).folder.parent.parent, FILE))
    if record is None:
        raise MissingError(f"{FILE}: not measured; runner reproduce thesis makes it")
    tried = np.array([row["joints"] for row in record["rows"]], dtype=float)
    times = {term: 1e6 * np.array([row[term] for row in record["rows"]]) for term in TERMS}
    total = np.sum([times[term] for term in ("mass_matrix", "coriolis_matrix", "gravity")], axis=0)
    long = tried >= fitted
    exponent, scale = np.polyfit(np.log(tried[long]), np.log(total[long]), 1)
    joints = int(tried[-1])
    return {
        "machine": str(record["machine"]),
        "arms": len(tried),
        "joints": joints,
        "six": Measured("M, C and G of six joints", float(np.interp(6.0, tried, total)), "µs"),
        "chain": Measured(f"M, C and G of {joints} joints", float(total[-1]), "µs"),
        "power": Measured(f"power of the time from {fitted} joints on", float(exponent)),
        "tried": tried,
        "times": times,
        "total": total,
        "law": (tried[long], np.exp(scale) * tried[long] ** exponent),
    }


def cost_table(cost: Mapping[str, Any], caption: str) -> Table:
    """Return the times by number of joints, of every doubling and of the longest chain; the curves show all."""
    shown = [*cost["times"].values()]
    shown.insert(3, cost["total"])
    chosen = [row for row in range(cost["arms"]) if (row + 1).bit_count() == 1 or row + 1 == cost["arms"]]
    rows = [[f"{cost['tried'][row]:.0f}", *(number(float(each[row])) for each in shown)] for row in chosen]
    return Table(caption, ["joints", "M", "C", "G", "M, C and G", "forward dynamics"], rows, tuple(range(6)))


def cost_curves(cost: Mapping[str, Any], caption: str) -> Curves:
    """Return them as curves, beside the power law."""
    fitted, times = cost["law"]
    series = (
        Series("M, C and G", cost["tried"], cost["total"], "points_line"),
        Series(f"power {cost['power'].value:.2f}", fitted, times, "dotted"),
        Series("forward dynamics", cost["tried"], cost["times"]["forward_dynamics"], "points_line"),
    )
    return Curves(caption, (Panel("", "joints", "time (µs)", series),), 1)
