"""List of the runs of a sweep: data for the page's script, and a short table for print."""

import base64
from typing import Any

import numpy as np

from runner.base.quantities import number, unit_text
from runner.base.sanitize import plain
from runner.reporting.document import RunList
from runner.reporting.metric_titles import metric_label
from runner.reporting.table import Table, numbers

Json = dict[str, Any]

SHOWN = 6
"""Metrics in the table; the details of a run have all of them."""
ON_PAPER_METRICS = 3
"""Metrics of the table on paper, whose heads must not run into each other."""
ON_PAPER = 20
"""Runs that are listed where nothing can be filtered."""


def run_list_spec(block: RunList) -> Json:
    """Return the content of the list in HTML: names, and a column of numbers for each axis and metric."""
    return {
        "axes": [{"name": plain(name), "values": [plain(value) for value in values]} for name, values in block.axes],
        "levels": [column.tolist() for column in block.levels.T],
        "metrics": [{"name": plain(name), "unit": plain(unit_text(unit))} for name, unit in block.metrics],
        "values": [_packed(column) for column in block.values.T],
        "hashes": list(block.hashes),
        "failures": [plain(failure) for failure in block.failures],
        "commands": [plain(command) for command in block.commands],
        "folders": list(block.folders),
        "shown": SHOWN,
    }


def first_runs(block: RunList) -> Table:
    """Return the first rows as a table for paper."""
    rows = []
    for run in range(min(ON_PAPER, len(block.hashes))):
        levels = zip(block.axes, block.levels[run], strict=True)
        values = (None if np.isnan(value) else float(value) for value in block.values[run, :ON_PAPER_METRICS])
        cells = [block.hashes[run][:8], *(names[level] for (_, names), level in levels)]
        rows.append([*cells, "failed" if block.failures[run] else "ok", *map(number, values)])
    metrics = [metric_label(name, unit) for name, unit in block.metrics[:ON_PAPER_METRICS]]
    header = ["run", *(name for name, _ in block.axes), "status", *numbers(*metrics)]
    return Table(block.caption, header, rows, block.origin)


def _packed(column: np.ndarray) -> str:
    return base64.b64encode(column.astype("<f4").tobytes()).decode("ascii")
