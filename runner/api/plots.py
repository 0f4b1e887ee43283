"""Matplotlib figures of a run's signals over time."""

import re
from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from runner.api.resimulate import Signals
from runner.base.errors import RunnerError, unknown
from runner.base.quantities import label_with_unit
from runner.reporting.charts.stills import as_figure, draw
from runner.reporting.document import Curves, Panel, Series
from runner.reporting.metric_titles import capital

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


def _curves(signals: Signals, name: str) -> Curves:
    known = families(list(signals.frame.columns))
    if name not in known:
        raise RunnerError(unknown("signal", name, known))
    title = _TITLES.get(name, name.replace("_", " "))
    units = dict.fromkeys(signals.units[column] for column in known[name].values())
    beside = known.get(_BESIDE.get(name, ""), {})
    return Curves("", [_panel(signals, title, unit, known[name], beside) for unit in units], columns=1)


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
