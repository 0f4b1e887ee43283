"""Signals of any repetition of a stored run, and their Matplotlib figures over time.

Every repetition except the first is simulated again.
"""

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from runner import store
from runner.base.errors import RunnerError, unknown
from runner.base.quantities import label_with_unit
from runner.reporting.charts.scales import curves_in_readable_units
from runner.reporting.charts.static import as_figure, as_png, draw
from runner.reporting.document import Curves, Panel, Series
from runner.reporting.metric_titles import capital
from runner.store.run import units_of

if TYPE_CHECKING:
    import pandas as pd


_JOINT = re.compile(r"(q|dq|tau)(\d+)(_command)?")
_AXIS = re.compile(r"(\w+)_([xyz])")
_NAMES = {"q": "position", "dq": "velocity", "tau": "torque", "q_command": "position_command"}
_TITLES = {
    "position": "joint position",
    "position_command": "commanded joint position",
    "velocity": "joint velocity",
    "torque": "joint torque",
    "error": "tip position error",
    "tip": "tip position",
    "desired": "desired tip position",
}
_BESIDE = {"tip": "desired"}  # signal drawn dashed together with another


@dataclass(frozen=True)
class Signals:
    """The signals of one repetition.

    Attributes:
        frame: One row per tick, one column per signal.
        units: Unit of each column.
    """

    frame: "pd.DataFrame"
    units: Mapping[str, str]


def signals_of(run: store.Run, repetition: int) -> Signals:
    """Return the signals of a repetition: the first is read from the store, any other is simulated again.

    The metrics of the new simulation must equal the stored metrics, to the last bit on the machine of the run. On
    another machine, or with other library versions, they must be equal up to rounding, and a warning states this.

    Raises:
        RunnerError: if there is no such repetition, or the code, the robot's file or the machine gives another result.
        DamagedError: if the run is damaged.
    """
    count = run.repetitions
    if not 0 <= repetition < count:
        raise RunnerError(f"repetition: run {run.hash} has no repetition {repetition}. Allowed: 0 to {count - 1}.")
    if repetition == 0 and run.text is None:
        return Signals(store.Run.trace(run).copy(), run.units)
    return _simulated(run, repetition)


def _simulated(run: store.Run, repetition: int) -> Signals:
    from runner.store.parquet import trace_table
    from runner.sweeps.rerun import simulate_again

    trace, warning = simulate_again(run, repetition)
    if warning:
        warnings.warn(warning, RuntimeWarning, stacklevel=5)  # at the caller of Run.trace
    table = trace_table(trace)
    return Signals(table.to_pandas(use_threads=False), units_of(table))


def families(columns: Sequence[str]) -> dict[str, dict[str, str]]:
    """Return the signals of a trace that are drawn together: the columns of each, by the name of the joint or axis.

    >>> families(["t", "q1", "tau1", "tau2", "error_x", "error_y"])
    {'position': {'1': 'q1'}, 'torque': {'1': 'tau1', '2': 'tau2'}, 'error': {'x': 'error_x', 'y': 'error_y'}}
    """
    found: dict[str, dict[str, str]] = {}
    for column in columns:
        joint, axis = _JOINT.fullmatch(column), _AXIS.fullmatch(column)
        if joint:
            found.setdefault(_NAMES[joint[1] + (joint[3] or "")], {})[joint[2]] = column
        elif axis:
            found.setdefault(axis[1], {})[axis[2]] = column
    return found


def figure_of(signals: Signals, name: str) -> Figure:
    """Return the figure of a signal over time: a panel for each unit, a curve for each joint or axis.

    Raises:
        RunnerError: if there is no such signal; lists the existing signals.
    """
    return as_figure(_curves(signals, name))


def svg_of(signals: Signals, name: str) -> str:
    """Return the figure of a signal as SVG; see `figure_of`."""
    return draw(_curves(signals, name))


def png_of(signals: Signals, name: str) -> bytes:
    """Return the figure of a signal as PNG; see `figure_of`."""
    return as_png(figure_of(signals, name))


def _curves(signals: Signals, name: str) -> Curves:
    known = families(list(signals.frame.columns))
    if name not in known:
        raise RunnerError(unknown("signal", name, known))
    title = _TITLES.get(name, name.replace("_", " "))
    units = dict.fromkeys(signals.units[column] for column in known[name].values())
    beside = known.get(_BESIDE.get(name, ""), {})
    panels = [_panel(signals, title, unit, known[name], beside) for unit in units]
    return curves_in_readable_units(Curves("", panels, columns=1))


def _panel(signals: Signals, title: str, unit: str, columns: Mapping[str, str], beside: Mapping[str, str]) -> Panel:
    shown = {label: column for label, column in columns.items() if signals.units[column] == unit}
    t = signals.frame["t"].to_numpy()
    series = [
        Series(label, t, signals.frame[column].to_numpy(), color=place)
        for place, (label, column) in enumerate(shown.items())
    ]
    series += [
        Series(f"{label} desired", t, signals.frame[beside[label]].to_numpy(), "dashed", color=place)
        for place, label in enumerate(shown)
        if label in beside
    ]
    if title == _TITLES["torque"] and unit == "N":
        title = "joint force"
    return Panel(capital(title), "time (s)", label_with_unit(title.split()[-1], unit), series)
