"""Figures of a stored run of arms riding on each other, laid out as the thesis does (figures 5.3 and 5.8 to 5.13)."""

from runner.reporting.document import Curves, Panel, Series
from runner.reporting.figures import AXES, columns, joint_columns, origin, until_time
from runner.store import Run


def staged_torque_and_error(run: Run, caption: str, number: str = "", until: float | None = None) -> Curves:
    """Return the torques of each stage's joints, and the errors of each stage's end point, over time.

    Stages have panels of their own, because their torques and errors differ by orders of magnitude. Joints count
    through the whole robot, 1 to 6; the error of a carrying stage is that to the desired tip less its offset at home.

    Args:
        run: A run of a robot with stages.
        caption: What is seen.
        number: Number of the figure in the source.
        until: End of the time axis, in s; None shows the whole run.
    """
    trace = until_time(run, until)
    t, torques = trace["t"].to_numpy(), joint_columns(trace, "tau")
    names = _stages(run)
    torque_panels, error_panels = [], []
    for name, joints in names.items():
        last = name == list(names)[-1]
        error = columns(trace, "error" if last else f"{name}_error")
        point = "T" if last else "E" if len(names) == 2 else name
        torque_panels.append(
            Panel(
                f"Torque of the {name.capitalize()}'s joints",
                "time (s)",
                "torque (N m)",
                [Series(str(joint + 1), t, torques[:, joint], color=joint) for joint in joints],
            )
        )
        error_panels.append(
            Panel(
                "Tip error" if last else f"Error of the {name.capitalize()}'s end point",
                "time (s)",
                "error (m)",
                [Series(f"{axis}_{point}", t, error[:, index], color=index) for index, axis in enumerate(AXES)],
            )
        )
    return Curves(caption, (*torque_panels, *error_panels), len(names), origin(run, number))


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
    carrier, rider = list(_stages(run))[:2]
    t = trace["t"].to_numpy()
    desired, tip, end_point = (trace[f"{stem}_{axis}"].to_numpy() for stem in ("desired", "tip", f"{carrier}_tip"))
    big, small = carrier.capitalize(), rider.capitalize()
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


def _stages(run: Run) -> dict[str, list[int]]:
    """Return the indices of each stage's joints by its name, from the base outwards."""
    names = list(run.provenance["stages"])
    stages: dict[str, list[int]] = {name: [] for name in names}
    for index, joint in enumerate(run.provenance["joints"]):
        riding = next((name for name in names[1:] if joint.startswith(f"{name}_")), names[0])
        stages[riding].append(index)
    return stages
