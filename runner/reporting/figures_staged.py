"""Figures of a stored Macro/Mini run in the layout of the thesis (figure 5.3)."""

from runner.reporting.document import Curves, Panel, Series
from runner.reporting.figures import origin, until_time
from runner.store import Run


def macro_mini_targets(
    run: Run, number: str = "", caption: str = "", until: float | None = None, axis: str = "x"
) -> Curves:
    """Return how the way to the desired tip is shared between the carrying arm and the riding one, along one axis.

    Args:
        run: A run of a robot with two stages.
        number: Number of the figure in the source.
        caption: What is seen; "" takes a sentence of its own.
        until: End of the time axis, in s; None shows the whole run.
        axis: The axis of the base frame: x, y or z.
    """
    trace = until_time(run, until)
    macro, mini = list(run.provenance["stages"])[:2]
    t = trace["t"].to_numpy()
    desired, tip, end_point = (trace[f"{stem}_{axis}"].to_numpy() for stem in ("desired", "tip", f"{macro}_tip"))
    big, small = macro.capitalize(), mini.capitalize()
    positions = (
        Series("tip", t, tip, color=0),
        Series(f"{big} end point", t, end_point, color=1),
        Series("desired tip", t, desired, "dashed", color=7),
    )
    shares = (
        Series(f"tip less {big} end point", t, tip - end_point, color=0),
        Series(f"desired tip less {big} end point", t, desired - end_point, "dashed", color=7),
    )
    panels = (
        Panel(f"Positions in {axis} direction", "time (s)", f"{axis} (m)", positions),
        Panel(f"The {small}'s share of them", "time (s)", f"{axis} (m)", shares),
    )
    caption = caption or f"How {big} and {small} share the way to the desired tip, in {axis} direction."
    return Curves(caption, panels, origin=origin(run, number))
