"""What the dynamics of M, C and G take today, from the file that the reproduction keeps."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from runner.quantities import number
from runner.reporting.document import Curves, Panel, Series, Table
from runner.reporting.job import MissingError
from runner.reporting.measured import Measured
from runner.store import Run
from runner.works.thesis.measure import FILE, TERMS, load


class _Cost:
    """Measured times of chains of mounted arms, in µs, and the power of the number of joints with which they grow."""

    def __init__(self, record: Mapping[str, Any], fitted: int) -> None:
        self._joints = np.array([row["joints"] for row in record["rows"]], dtype=float)
        self._times = {term: 1e6 * np.array([row[term] for row in record["rows"]]) for term in TERMS}
        self._total = np.sum([self._times[term] for term in ("mass_matrix", "coriolis_matrix", "gravity")], axis=0)
        long = self._joints >= fitted
        exponent, scale = np.polyfit(np.log(self._joints[long]), np.log(self._total[long]), 1)
        self._law = self._joints[long], np.exp(scale) * self._joints[long] ** exponent
        self.machine, self.arms, self.joints = str(record["machine"]), len(self._joints), int(self._joints[-1])
        self.six = Measured("M, C and G of six joints", float(np.interp(6.0, self._joints, self._total)), "µs")
        self.chain = Measured(f"M, C and G of {self.joints} joints", float(self._total[-1]), "µs")
        self.power = Measured(f"power of the time from {fitted} joints on", float(exponent))

    def table(self, caption: str) -> Table:
        """Return the times by number of joints, of every doubling and of the longest chain; the curves show all."""
        shown = [*self._times.values()]
        shown.insert(3, self._total)
        chosen = [row for row in range(self.arms) if (row + 1).bit_count() == 1 or row + 1 == self.arms]
        rows = [[f"{self._joints[row]:.0f}", *(number(float(each[row])) for each in shown)] for row in chosen]
        return Table(caption, ["joints", "M", "C", "G", "M, C and G", "forward dynamics"], rows, tuple(range(6)))

    def curves(self, caption: str) -> Curves:
        """Return them as curves, beside the power law."""
        series = (
            Series("M, C and G", self._joints, self._total, "points_line"),
            Series(f"power {self.power.value:.2f}", *self._law, "dotted"),
            Series("forward dynamics", self._joints, self._times["forward_dynamics"], "points_line"),
        )
        return Curves(caption, (Panel("", "joints", "time (µs)", series),), 1)


def measured_cost(runs: Mapping[str, Run], fitted: int) -> _Cost:
    """Return the measurement that lies beside the runs.

    Raises:
        MissingError: if there is none.
    """
    record = load(Path(next(iter(runs.values())).folder.parent.parent, FILE))
    if record is None:
        raise MissingError(f"{FILE}: not measured; runner reproduce thesis makes it")
    return _Cost(record, fitted)
