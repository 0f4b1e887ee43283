"""Thesis figures under both presets: a panel for each joint and axis, with the printed values."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import above_rounding, format_range, number, quantity
from runner.metrics.caveats.torques import CHATTER
from runner.reporting.charts.figure import envelope
from runner.reporting.document import Panel, Series
from runner.reporting.figures import AXES, rows_until
from runner.reporting.metric_titles import title
from runner.reporting.plant_step import describe_plant, percent
from runner.reporting.published_claims import PublishedClaim, judge, load_claims
from runner.reporting.words import PLANT
from runner.store import Run

APART = 20.0
"""From which ratio of their largest errors on two presets have axes of their own."""
_LONG, _TOGETHER = 1000, 0.01  # ticks from which on a curve is an envelope, and the time that makes a point of it, in s
_SHORT = 0.05  # s, of which the ticks themselves are shown
_AT_REST = 1.0  # s before the end in which a printed error at rest is drawn
_COLORS, _GREY = (1, 0), 7  # indices into the palette
_EMPTY: FloatArray = np.zeros(0)


@dataclass(frozen=True)
class Compared:
    """A figure's runs and what is shown of them.

    Attributes:
        runs: The run under each preset, by the preset's words.
        claims: What the thesis prints of it, with a number.
        until: End of the time axis, in s; None shows the whole runs.
    """

    runs: Mapping[str, Run]
    claims: Sequence[PublishedClaim] = ()
    until: float | None = None

    def errors_apart(self, signal: str = "error") -> float:
        """Return by which factor the largest errors of a signal differ between the presets."""
        low, high = sorted(_largest(run.vector(signal)[rows_until(run, self.until)]) for run in self.runs.values())
        return high / low if low > 0.0 else np.inf

    def scales(self) -> str:
        """Return by which factor the errors differ where the presets do not share axes; nothing where they do."""
        far = {whose: self.errors_apart(signal) for signal, whose in self._signals().items()}
        told = [f"{whose} differ by a factor of {number(factor, 2)}" for whose, factor in far.items() if factor > APART]
        return f"{' and '.join(told)}, so each preset has axes of its own there." if told else ""

    def chatters(self) -> bool:
        """Tell whether a torque of some run jumps from limit to limit, as a rule found at its end."""
        return any(caveat["rule"] == CHATTER.name for run in self.runs.values() for caveat in run.caveats)

    def torques(self, joints: Sequence[int]) -> list[Panel]:
        """Return the torque of some joints, counted from 1, a panel for each."""
        return [self._panel(f"Joint {joint}: torque", "torque (N m)", self._curves(f"tau{joint}")) for joint in joints]

    def ticks(self, joints: Sequence[int]) -> list[Panel]:
        """Return the last ticks of these torques as they are."""
        title = f"the last {quantity(_SHORT, 's')}"
        return [
            self._panel(f"Joint {joint}: {title}", "torque (N m)", self._curves(f"tau{joint}", last=_SHORT))
            for joint in joints
        ]

    def errors(self, signal: str, whose: str) -> list[Panel]:
        """Return the error of a point in x, y and z; of presets that are far apart a row of panels for each."""
        rows: list[Sequence[str]] = [list(self.runs)]
        if self.errors_apart(signal) > APART:
            rows = [[words] for words in self.runs]
        return [
            self._with_printed(f"{whose}, {axis}", self._curves(f"{signal}_{axis}", only=row), signal)
            for row in rows
            for axis in AXES
        ]

    def enlarged(self) -> list[Panel]:
        """Return the tip's error on the scale of the error at rest that is printed; nothing where none is."""
        claim = next((each for each in self.claims if each.metric == "steady_state_error"), None)
        if claim is None or claim.value is None:
            return []
        seen = max(claim.value, *(_largest(_at_rest(run)) for run in self.runs.values()))
        panels = []
        for axis in AXES:
            curves = self._curves(f"error_{axis}")
            lines = self._levels(claim, self._end - _AT_REST)
            panels.append(self._panel(f"Tip error, {axis}, enlarged", "error (m)", [*curves, *lines], 1.7 * seen))
        return panels

    def _signals(self) -> dict[str, str]:
        """Return the errors that a figure shows, with their names at the start of a sentence."""
        staged = all(len(run.provenance["stages"]) > 1 for run in self.runs.values())
        return {"error": "The tip's errors", **({"macro_error": "the Macro's"} if staged else {})}

    @property
    def _end(self) -> float:
        return max(float(run.t[rows_until(run, self.until)][-1]) for run in self.runs.values())

    def _panel(self, title: str, label: str, curves: Sequence[Series], most: float = 0.0) -> Panel:
        return Panel(title, "time (s)", label, curves, y_range=(-most, most) if most else None)

    def _curves(self, column: str, only: Sequence[str] | None = None, last: float | None = None) -> list[Series]:
        """Return a column of each run; an empty curve for a preset that is left out, so that the legend is one."""
        curves = []
        for color, (words, run) in zip(_COLORS, self.runs.items(), strict=True):
            rows = rows_until(run, self.until)
            t, y = run.t[rows], run.trace()[column].to_numpy()[rows]
            if only is not None and words not in only:
                t, y = _EMPTY, _EMPTY
            elif last is not None:
                t, y = t[t >= t[-1] - last - 1e-9], y[t >= t[-1] - last - 1e-9]
            series = Series(words, t, y, "line" if color == _COLORS[0] else "dashed", color=color)
            curves.append(envelope(series, round(_TOGETHER / (t[1] - t[0]))) if t.size > _LONG else series)
        return curves

    def _with_printed(self, title: str, curves: list[Series], signal: str) -> Panel:
        """Return an error's panel with the printed values that can be seen on its axes."""
        seen = max(_largest(edge) for each in curves for edge in (each.y, each.low, each.high) if edge is not None)
        lines: list[Series] = []
        for claim in self.claims if signal == "error" else ():
            value = claim.value or 0.0
            if claim.metric == "settling_time":
                lines.append(_line([value, value], [seen, -seen], _told(claim)))
            elif seen / APART < value < APART * seen:
                lines += self._levels(claim, 0.0 if claim.metric == "max_axis_error" else self._end - _AT_REST)
        return self._panel(title, "error (m)", [*curves, *lines])

    def _levels(self, claim: PublishedClaim, start: float) -> list[Series]:
        value = claim.value or 0.0
        return [_line([start, self._end], [sign * value] * 2, _told(claim) if sign > 0 else "") for sign in (1.0, -1.0)]


def _line(x: Sequence[float], y: Sequence[float], label: str) -> Series:
    return Series("", np.array(x, dtype=float), np.array(y, dtype=float), "dotted", color=_GREY, label=label)


def _told(claim: PublishedClaim) -> str:
    low, high = claim.printed[0], claim.printed[-1]
    return f"printed {quantity(high, claim.unit) if low == high else format_range(low, high, claim.unit)}"


def _at_rest(run: Run) -> FloatArray:
    error: FloatArray = run.vector("error")[run.t >= run.t[-1] - 0.5 * _AT_REST]
    return error


def _largest(values: FloatArray) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


_METRICS = {"settling_time": "settles after", "steady_state_error": "rests within", "max_axis_error": "strays by"}


def step_of_both(named: Mapping[str, Run], metrics: Sequence[str]) -> str:
    """Return what the plant's step is worth in a figure's metrics, under both presets, in a sentence.

    Where none of the metrics has a value, it is how far the step moves the tip. Nothing is said here of runs whose
    motion parts from that on Runge-Kutta; see `parting`.
    """
    errors = {words: run.plant_error or {"reason": ""} for words, run in named.items()}
    if any("reason" in error for error in errors.values()):
        return " ".join(
            f"{words[0].upper()}{words[1:]}: {describe_plant(run, metrics)}" for words, run in named.items()
        )
    told = []
    for metric in metrics:
        shares = {words: error["metrics"].get(metric, {}).get("share") for words, error in errors.items()}
        known = [f"{percent(share)} ({words})" for words, share in shares.items() if share is not None]
        told += [f"{' and '.join(known)} of the {title(metric)}"] if known else []
    first = next(iter(named.values()))
    step = f"{_plant(first)}'s step of {quantity(first.provenance['plant_step'], 's')}"
    if told:
        return f"{step} is worth {'; '.join(told)}."
    moved = [
        f"{above_rounding(error['largest'], 'm', 2)} ({words})"
        for words, error in errors.items()
        if error["parted"] is None
    ]
    return f"{step} moves the tip by {' and '.join(moved)} at most." if moved else ""


def parting(named: Mapping[str, Run], claims: Mapping[str, int]) -> list[str]:
    """Return what became of the runs whose motion parts from that on Runge-Kutta.

    Args:
        named: The run under each preset, by the preset's words.
        claims: The claims on the figure, by metric.
    """
    told = []
    for words, run in named.items():
        error = run.plant_error or {}
        if error.get("parted") is not None:
            told.append(_parted(words, run, error, claims))
    plant = _plant(next(iter(named.values())))
    why = f"What makes such differences grow is said under {plant} against Runge-Kutta."
    return [*told, why] if told else []


def _parted(words: str, run: Run, error: Mapping[str, Any], claims: Mapping[str, int]) -> str:
    saturated = run.median("saturation_fraction")
    text = (
        f"{words[0].upper()}{words[1:]}: some torque is at its limit for {number(100.0 * (saturated or 0.0), 2)} % of "
        f"the ticks; Runge-Kutta, with the same noise, goes another way from {quantity(error['parted'], 's')} on, "
        f"{above_rounding(error['largest'], 'm', 2)} away at {quantity(error['at'], 's')}, and "
        f"{above_rounding(error['end'], 'm', 2)} at the end."
    )
    return " ".join([text, *(_of_metric(metric, claim, run, error) for metric, claim in claims.items())]).strip()


def _of_metric(metric: str, claim: int, run: Run, error: Mapping[str, Any]) -> str:
    """Return whether Runge-Kutta's value lies among the repetitions', and what it means for the verdict."""
    stored, other = run.metrics[metric], error["metrics"].get(metric, {}).get("value")
    low, high, unit = stored.min, stored.max, stored.unit
    if other is None or low is None or high is None:
        return ""
    inside = low <= other <= high
    printed = next(each.value for each in load_claims("thesis") if each.number == claim)
    ours, theirs = (judge(printed or 0.0, value) for value in (stored.median, other))
    if ours == theirs and metric != "settling_time":
        return ""
    text = (
        f"There the tip {_METRICS[metric]} {quantity(other, unit)}, {'within' if inside else 'outside'} the "
        f"{format_range(low, high, unit)} of {_plant(run)}'s {run.record['repetitions']} repetitions"
    )
    return f"{text}." if ours == theirs else f"{text}: claim {claim} would read {theirs} in place of {ours}."


def _plant(run: Run) -> str:
    kind = str(run.config["plant"]["kind"])
    return PLANT.get(kind, kind)
