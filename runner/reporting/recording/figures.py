"""Figures that compare a recording with a run."""

import numpy as np

from runner.base.quantities import label_with_unit
from runner.recordings.compare import RecordingComparison
from runner.recordings.residuals import Residual
from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.document import Curves, Panel, Series
from runner.reporting.figures import origin
from runner.reporting.markup import literal

_MOST_POINTS = 600
_RECORDED, _SIMULATED = 0, 1  # colours


def both(found: RecordingComparison) -> Curves:
    """Return each signal of the recording and of the run over time."""
    panels = [
        Panel(
            literal(_capital(one.signal.words)),
            "time of the run (s)",
            label_with_unit(one.signal.kind, one.unit),
            [
                Series("recorded", one.t, one.recorded, color=_RECORDED),
                Series("run", one.t, one.simulated, "dashed", color=_SIMULATED),
            ],
        )
        for one in found.residuals
    ]
    return Curves("Each recorded signal, and that of the run.", panels, origin=origin(found.run))


def residuals(found: RecordingComparison) -> Curves:
    """Return what is recorded less what was simulated: positions, torques and the tip, each together."""
    groups: dict[tuple[str, str], list[Residual]] = {}
    for one in found.residuals:
        groups.setdefault((one.signal.kind, one.unit), []).append(one)
    panels = [
        Panel(
            f"{_capital(kind)}, recorded - run",
            "time of the run (s)",
            label_with_unit("residual", unit),
            [Series(literal(one.signal.of), one.t, one.values) for one in group],
        )
        for (kind, unit), group in groups.items()
    ]
    return Curves("Residuals over time.", panels, origin=origin(found.run))


def lags(found: RecordingComparison) -> Curves:
    """Return the correlation of the speeds over the time of the recording at which the run begins."""
    offset = found.offset
    best = int(np.argmax(offset.correlations))
    shown = np.unique(
        np.append(spaced_indices(len(offset.lags), _MOST_POINTS), np.arange(max(0, best - 50), best + 50))
    )
    shown = shown[shown < len(offset.lags)]
    found_at = np.full(2, offset.start)
    panel = Panel(
        "Correlation of the speeds",
        "begin of the run in the recording (s)",
        "correlation",
        [
            Series("", offset.lags[shown], offset.correlations[shown], color=_RECORDED),
            Series("", found_at, np.array([min(0.0, float(offset.correlations.min())), 1.0]), "dotted", color=1),
        ],
    )
    caption = "Where the speeds of the recording and of the run correlate best; the dotted line is the time found."
    return Curves(caption, [panel], columns=1, origin=origin(found.run))


def friction(found: RecordingComparison) -> Curves:
    """Return the residual torque of each joint against its speed, and the friction identified."""
    panels = []
    for joint in () if found.friction is None else found.friction.joints:
        turns = joint.unit == "rad"
        order = np.argsort(joint.speed)
        speed = joint.speed[order]
        line = joint.viscous * speed + joint.coulomb * np.sign(speed)
        gap = int(np.searchsorted(speed, 0.0))  # the line jumps at rest
        x, y = np.insert(speed, gap, np.nan), np.insert(line, gap, np.nan)
        series = [
            Series("residual torque", joint.speed, joint.torque, "points", color=_RECORDED),
            Series("friction", x, y, color=_SIMULATED),
        ]
        label = label_with_unit("torque" if turns else "force", "N m" if turns else "N")
        panels.append(Panel(literal(joint.joint), label_with_unit("speed", f"{joint.unit}/s"), label, series))
    caption = "Torque that the run's model and other masses leave over, against the speed, and the friction identified."
    return Curves(caption, panels, origin=origin(found.run))


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
