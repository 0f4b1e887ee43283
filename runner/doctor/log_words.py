"""Words for an examined log: its format, and a line for each column with range, rate, resolution and repeats."""

from collections.abc import Iterator

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.base.sanitize import few, one_line
from runner.doctor.log import LogExamination
from runner.doctor.log_meanings import ONLY_COMMANDS, Meaning
from runner.schema.units import WRITTEN

_MOST_ROWS = 20_000  # that tell a resolution


def log_lines(found: LogExamination) -> Iterator[str]:
    """Yield what a log is, its columns with their meaning, and the findings."""
    table = found.table
    writer = f", written by {found.writer}" if found.writer else ""
    yield one_line(
        f"{table.path.name}: {table.form}{writer}; {len(table):,} rows, {len(table.columns)} columns of numbers"
    )
    if found.time is not None:
        yield one_line(_time_line(table.columns[found.time.column], found.time))
    known = {one.column for one in found.meanings} | ({found.time.column} if found.time else set())
    for one in found.meanings:
        yield one_line(f"column  {one.column}: {_meant(one)} ({one.reason}); {_facts(table.columns[one.column])}")
    rest = [name for name in table.columns if name not in known]
    if rest and not found.meanings:
        for name in rest:
            yield one_line(f"column  {name}: {_facts(table.columns[name])}")
    elif rest:
        yield one_line(f"others  {few(rest)}: no meaning for a comparison")
    if table.others:
        yield one_line(f"others  {few(list(table.others))}: not read")
    for finding in found.findings:
        yield one_line(str(finding))
    if found.motion is not None:
        commanded = found.motion.commanded or any(ONLY_COMMANDS in one.reason for one in found.meanings)
        what = "commanded" if commanded else "measured"
        yield f"motion  the {what} positions of the log"


def _meant(one: Meaning) -> str:
    return ", ".join(f"{key} {'?' if value is None else value}" for key, value in one.keys.items())


def _time_line(values: FloatArray, time: Meaning) -> str:
    factor = float(WRITTEN["s"].get(str(time.keys.get("unit")), 1.0))
    steps = np.diff(values[~np.isnan(values)]) * factor
    forward = steps[steps > 0.0]
    lasts = quantity(float(np.nanmax(values) - np.nanmin(values)) * factor, "s")
    text = f"time    {time.column}: {time.keys.get('unit') or '?'} ({time.reason}); lasts {lasts}"
    if len(forward):
        text += f", steps of {quantity(float(np.median(forward)), 's')}, at most {quantity(float(forward.max()), 's')}"
    repeated, back = int(np.sum(steps == 0.0)), int(np.sum(steps < 0.0))
    return text + f", {repeated} repeat" * bool(repeated) + f", {back} run back" * bool(back)


def _facts(values: FloatArray) -> str:
    known = values[~np.isnan(values)]
    if not len(known):
        return "empty"
    low, high = float(known.min()), float(known.max())
    if low == high:
        return f"always {low:.6g}"
    steps = np.abs(np.diff(known[:_MOST_ROWS]))
    text = f"{low:.6g} to {high:.6g}"
    if (steps > 0.0).any():
        text += f", resolution {steps[steps > 0.0].min():.2g}"
    if len(known) < len(values):
        text += f", {1.0 - len(known) / len(values):.0%} missing"
    same = float(np.mean(steps == 0.0)) if len(steps) else 0.0
    return text + f", {same:.0%} repeat the row before" * (same > 0.01)
