"""Flow chart of the steps of stage-wise control (thesis figure 5.6)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon

from runner.base.arrays import FloatArray
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import INK, arrow, drawing, scene, write

# Measures in inches, at the size on paper.
_COLUMN, _ROW = 2.75, 0.96
_ACTION, _DECISION = np.array([1.02, 0.26]), np.array([1.02, 0.4])  # half sizes
_RETURN = 0.25  # from the rightmost block to the line that goes back
_FONT = 8.5


@dataclass(frozen=True)
class Step:
    """One step of a control period.

    Attributes:
        name: Its name.
        kind: Whether it does something or asks something.
        text: What it does or asks.
        column: Its place, left to right.
        row: Its place, top to bottom.
        then: The next step by answer; by "" where nothing is asked. Nothing leads on to the next period.
    """

    name: str
    kind: Literal["action", "decision"]
    text: str
    column: int
    row: int
    then: dict[str, str] = field(default_factory=dict)


def steps(schedule: str, beyond_reach: str) -> tuple[Step, ...]:
    """Return the steps of `MacroController` and a following `MiniController` in each period, the first step first.

    Args:
        schedule: both, both arms move at any time; or turns, a period of the Macro's each.
        beyond_reach: hold or stretch: what the Mini does where its target is beyond reach.

    Raises:
        ValueError: for another schedule or behaviour.
    """
    if schedule not in ("both", "turns") or beyond_reach not in ("hold", "stretch"):
        raise ValueError(f"no control steps for schedule {schedule!r} and beyond_reach {beyond_reach!r}")
    beyond = "Mini holds its posture" if beyond_reach == "hold" else "Mini stretches towards its target"
    measure = "Measure all joints;\n" + r"Mini's target $R^T r$, $r = x_d - x_E$"
    reach = "Mini's target\nwithin reach?\n" + r"$|r| \leq \rho$"
    if schedule == "both":
        return (
            Step("measure", "action", measure, 0, 0, {"": "macro"}),
            Step("macro", "action", "Macro moves\ntowards its target", 0, 1, {"": "reach"}),
            Step("reach", "decision", reach, 0, 2, {"yes": "follow", "no": "beyond"}),
            Step("follow", "action", "Mini moves to its target", 0, 3),
            Step("beyond", "action", beyond, 1, 2),
        )
    return (
        Step("measure", "action", measure, 0, 0, {"": "turn"}),
        Step("turn", "decision", "Mini's turn?", 0, 1, {"yes": "reach", "no": "macro"}),
        Step("reach", "decision", reach, 0, 2, {"yes": "follow", "no": "beyond"}),
        Step("follow", "action", "Macro holds its posture,\nMini moves to its target", 0, 3),
        Step("macro", "action", "Macro moves towards its target,\nMini holds its posture", 1, 1),
        Step("beyond", "action", f"Macro moves towards its target,\n{beyond}", 1, 2),
    )


@drawing
def control_steps(schedule: str, beyond_reach: str) -> Figure:
    """Draw the control steps of a schedule; see `steps`."""
    chart = steps(schedule, beyond_reach)
    corners = np.array([_centre(step) + sign * _half(step) for step in chart for sign in (-1.0, 1.0)])
    low, high = corners.min(axis=0) - 0.1, corners.max(axis=0) + 0.1 + [_RETURN, 0.0]
    figure, axes = scene(*(high - low))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    by_name = {step.name: step for step in chart}
    for step in chart:
        _draw_step(axes, step)
        for answer, name in step.then.items():
            _draw_way(axes, step, by_name[name], answer)
    _draw_return(axes, chart, corners[:, 0].max() + _RETURN)
    return figure


def _centre(step: Step) -> FloatArray:
    return np.array([step.column * _COLUMN, -step.row * _ROW])


def _half(step: Step) -> FloatArray:
    return _DECISION if step.kind == "decision" else _ACTION


def _draw_step(axes: Axes, step: Step) -> None:
    centre, half = _centre(step), _half(step)
    if step.kind == "decision":
        outline = centre + half * np.array([[-1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [0.0, -1.0]])
        axes.add_patch(Polygon(outline, fc="#fbf3e2", ec=palette.LIGHT[3], lw=0.9, zorder=3))
    else:
        low, size = centre - half, 2.0 * half
        box = FancyBboxPatch((low[0], low[1]), size[0], size[1], boxstyle="round,pad=0,rounding_size=0.02",
                             fc="#eef3fa", ec=palette.LIGHT[0], lw=0.9, zorder=3)  # fmt: skip
        axes.add_patch(box)
    write(axes, centre, step.text, _FONT, halo=False)


def _draw_way(axes: Axes, step: Step, following: Step, answer: str) -> None:
    down = following.column == step.column
    side = np.array([0.0, -1.0]) if down else np.array([1.0, 0.0])
    start, end = _centre(step) + side * _half(step), _centre(following) - side * _half(following)
    arrow(axes, start, end, INK, 0.9, 2.0)
    if answer:
        write(axes, (start + end) / 2.0 + ([0.17, 0.02] if down else [0.0, 0.1]), answer, _FONT, halo=False)


def _draw_return(axes: Axes, chart: Sequence[Step], right: float) -> None:
    """Draw the way from every last step back to the first: the next period."""
    first = _centre(chart[0])
    end = first + np.array([_half(chart[0])[0], 0.0])
    for step in chart:
        if not step.then:
            start = _centre(step) + np.array([_half(step)[0], 0.0])
            axes.plot([start[0], right, right], [start[1], start[1], first[1]], color=INK, lw=0.9, zorder=1)
    arrow(axes, np.array([right, first[1]]), end, INK, 0.9, 2.0)
    write(axes, np.array([(right + end[0]) / 2.0, first[1] + 0.1]), "next period", _FONT, halo=False)
