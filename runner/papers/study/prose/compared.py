"""Published figure, simulated: torques and errors under all presets in one panel, with printed values."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import format_range, quantity
from runner.papers.reporting.published_claims import PublishedClaim, compared_with
from runner.papers.study.claims import run_name
from runner.papers.study.prose.plots import Style
from runner.papers.study.results import Runs
from runner.reporting.charts.figure import envelope
from runner.reporting.document import Curves, Panel, Series
from runner.reporting.figures import AXES, captioned, origin, rows_until
from runner.store import Run

_STYLES: tuple[Style, ...] = ("line", "dashed", "dotted")
_GREY = 7  # palette index
_SHORT = 0.05  # s at the end in which torques that chatter are shown tick by tick
_AT_REST = 1.0  # s at the end in which a printed steady-state error is drawn
_POINTS, _TOGETHER = 1000, 0.02  # a longer curve is drawn as an envelope of intervals of this length, in s
_NARROW = 0.01  # of the range of a curve: a band that is narrower on average is not drawn
_WIDE = 0.5  # of the range of a curve: a band that is wider on average would hide the panel
_VISIBLE = 20.0  # a printed value that is this many times larger or smaller than all curves is not drawn
_EMPTY: FloatArray = np.zeros(0)


def compare(
    runs: Runs,
    presets: Mapping[str, str],
    claims: Sequence[PublishedClaim],
    caption: str,
    experiment: str,
    number: str = "",
    until: float | None = None,
) -> Curves:
    """Return a published figure: torques and tip error of an experiment, all presets in one panel.

    An arm of two stages has a panel of torques for each, and one for the error of the stage that carries. A goal has
    a panel of the tip error on the scale of its value at rest.

    Args:
        runs: The runs of the study by name.
        presets: The presets with their labels; the first is drawn solid, the second dashed.
        claims: The claims of the study; the printed values of this experiment are drawn dotted.
        caption: Finding and, after a line break, what is shown.
        experiment: Name of the experiment: the runs are EXPERIMENT/PRESET.
        number: Its number in the source.
        until: End of the time axis, in s; None shows the whole runs.
    """
    shown = {words: runs[run_name(experiment, preset)] for preset, words in presets.items()}
    first = next(iter(shown.values()))
    own = [claim for claim in claims if claim.simulated_by[0] == experiment]
    values = {claim.metric: (claim, _value(claim, runs, next(iter(presets)))) for claim in own}
    figure = _Figure(shown, {metric: (each, value) for metric, (each, value) in values.items() if value}, until)
    stages = [name for name in first.provenance["stages"] if len(first.provenance["stages"]) > 1]
    joints = [str(name) for name in first.provenance["joints"]]
    last = [name for name in joints if not stages or name.startswith(f"{stages[-1]}_")]
    groups = {"Torque": joints} if not stages else {
        f"{stages[0].capitalize()} torque": joints[: len(joints) - len(last)],
        f"{stages[-1].capitalize()} torque": last,
    }  # fmt: skip
    panels = [figure.torques(title, [joints.index(name) + 1 for name in group]) for title, group in groups.items()]
    if any(caveat["rule"] == "chatter" for run in shown.values() for caveat in run.caveats):
        ticks = [joints.index(name) + 1 for name in (last if stages else joints)]
        panels.append(figure.torques(f"{[*groups][-1]}, last {quantity(_SHORT, 's')}", ticks, _SHORT))
    panels += [figure.error(f"{stages[0].capitalize()} end point, error", f"{stages[0]}_error")] if stages else []
    panels.append(figure.error("Tip error", "error", "settling_time", "max_axis_error"))
    if first.config["trajectory"]["kind"] == "goal" and "steady_state_error" in figure.values:
        panels.append(figure.error("Tip error at rest", "error", "steady_state_error", enlarged=True))
    elif first.config["trajectory"]["kind"] != "goal":
        panels[-1] = figure.error("Tip error", "error", "max_axis_error", "steady_state_error")
    return captioned(caption, panels, 2 if len(panels) in (2, 4) else 3, origin(first, number))


class _Figure:
    """The panels of a figure.

    Args:
        shown: The run under each preset, by the preset's label.
        values: Claims of the figure and what they are compared with, by metric.
        until: End of the time axis, in s; None shows the whole runs.
    """

    def __init__(
        self, shown: Mapping[str, Run], values: Mapping[str, tuple[PublishedClaim, float]], until: float | None
    ) -> None:
        self.values, self._shown, self._until = values, shown, until
        self._end = max(float(run.t[rows_until(run, until)][-1]) for run in shown.values())

    def torques(self, title: str, joints: Sequence[int], last: float | None = None) -> Panel:
        """Return the torques of some joints, counted from 1; with `last` those of the last seconds."""
        curves = self._curves({str(joint): f"tau{joint}" for joint in joints}, last)
        lines = [replace(each, low=None, high=None) if _is_bar(each) else each for each in curves]
        told = f" (means over {quantity(_TOGETHER, 's')})" if any(map(_is_bar, curves)) else ""
        return Panel(f"{title}{told}", "time (s)", "torque (N m)", lines)

    def error(self, title: str, signal: str, *metrics: str, enlarged: bool = False) -> Panel:
        """Return an error along x, y and z, with the printed values of some metrics that its scale can show."""
        curves = self._curves({axis: f"{signal}_{axis}" for axis in AXES})
        rest = [run.vector(signal)[run.t >= run.t[-1] - 0.5 * _AT_REST] for run in self._shown.values()]
        seen = max(map(_largest, rest if enlarged else (edge for each in curves for edge in (each.y, each.high))))
        given = {
            metric: self.values[metric]
            for metric in metrics
            if metric in self.values
            and (
                enlarged
                or metric == "settling_time"
                or 1.0 / _VISIBLE < self.values[metric][1] / (seen or 1.0) < _VISIBLE
            )
        }
        lines = [line for metric, (_, value) in given.items() for line in self._lines(metric, value, seen)]
        told = f" (dotted: {', '.join(_words(*each) for each in given.values())})" if given else ""
        most = 1.7 * max([seen, *(value for _, value in given.values())]) if enlarged else None
        y_range = None if most is None else (-most, most)
        return Panel(f"{title}{told}", "time (s)", "error (m)", [*curves, *lines], y_range=y_range)

    def _curves(self, columns: Mapping[str, str], last: float | None = None) -> list[Series]:
        """Return columns of each run, named at their peaks; the legend names the presets."""
        curves: list[Series] = []
        for style, (words, run) in zip(_STYLES, self._shown.items(), strict=False):
            curves.append(Series(words, _EMPTY, _EMPTY, style, color=_GREY))
            rows = rows_until(run, self._until)
            kept = run.t[rows] >= (run.t[rows][-1] - last - 1e-9 if last else -np.inf)
            for color, (name, column) in enumerate(columns.items()):
                t, y = run.t[rows][kept], run.signal(column)[rows][kept]
                series = Series("", t, y, style, color=color)
                if t.size > _POINTS:
                    series = _bounded(envelope(series, round(_TOGETHER / (t[1] - t[0]))))
                curves.append(series)
                if style == _STYLES[0] and np.isfinite(y).any():
                    peak = [int(np.nanargmax(np.abs(y)))]
                    curves.append(replace(series, x=t[peak], y=y[peak], low=None, high=None, label=name))
        return curves

    def _lines(self, metric: str, value: float, seen: float) -> list[Series]:
        """Return a printed time as an upright line, and a printed error as levels of both signs."""
        if metric == "settling_time":
            return [_dotted([value, value], [-seen, seen])]
        start = self._end - _AT_REST if metric == "steady_state_error" else 0.0
        return [_dotted([start, self._end], [sign * value, sign * value]) for sign in (1.0, -1.0)]


def _value(claim: PublishedClaim, runs: Runs, preset: str) -> float | None:
    """Return the printed value of a claim, or that of the run that it is said to be like."""
    return compared_with(claim, lambda run, metric: runs[run_name(run, preset)].median(metric))


def _words(claim: PublishedClaim, value: float) -> str:
    if not claim.printed:
        return f"compared with {quantity(value, claim.unit)}"
    low, high = claim.printed[0], claim.printed[-1]
    return f"printed {quantity(high, claim.unit) if low == high else format_range(low, high, claim.unit)}"


def _bounded(series: Series) -> Series:
    """Return an envelope without its band if that is too narrow to be seen."""
    assert series.low is not None  # noqa: S101 - an envelope has both edges
    assert series.high is not None  # noqa: S101
    seen = np.mean(series.high - series.low) > _NARROW * np.ptp(series.y)
    return series if seen else replace(series, low=None, high=None)


def _is_bar(series: Series) -> bool:
    """Tell if a curve goes from limit to limit so often that its band fills the panel."""
    if series.low is None or series.high is None:
        return False
    return bool(np.mean(series.high - series.low) > _WIDE * (np.max(series.high) - np.min(series.low)))


def _dotted(x: Sequence[float], y: Sequence[float]) -> Series:
    return Series("", np.array(x), np.array(y), "dotted", color=_GREY)


def _largest(values: FloatArray | None) -> float:
    finite = np.zeros(0) if values is None else np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0
